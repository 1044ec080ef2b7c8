#pragma once
// The closed loop that every C++ peer goes through, and what is measured in it: the twin of ../closed_loop.py.

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace peers {

using Vector = Eigen::VectorXd;
using Matrix3 = Eigen::Matrix<double, 3, 3>;
using Vector3 = Eigen::Vector3d;

constexpr int fine = 10;           // the continuity of a command is judged by cycles so many times shorter
constexpr double give_up_s = 0.2;  // failures in a row after which a run ends
constexpr double orientation_weight = 1e4;  // beside 1 of the position, where weights stand for levels
constexpr double near_rad = 0.75;           // a target turned as far asks for no more than the joints' speed
constexpr double braking = 50.0;            // rad/s2 or m/s2; how joints stop where a torque controller fails

struct Pose {
  Matrix3 rotation = Matrix3::Identity();
  Vector3 position = Vector3::Zero();
};

struct Joint {
  std::string name;
  bool prismatic = false;
  Vector3 axis = Vector3::UnitZ();
  Pose placement{};
};

/// The scenario's file; vectors are over the joints of the chain.
struct Setup {
  std::string urdf{};
  std::string config{};
  std::string mode{};
  double dt = 0.0;
  double duration = 0.0;
  int repeats = 1;
  double gain = 0.0;
  double posture_gain = 0.0;
  double limit_gain = 0.0;
  Vector start{}, lower{}, upper{}, velocity{}, effort{}, rotor_inertia{};
  std::vector<Joint> joints{};
  Pose tip{};
  std::vector<std::pair<std::string, Pose>> goals{};

  bool torque() const { return mode == "torque"; }
  const Vector& bounds() const { return torque() ? effort : velocity; }
};

inline Pose read_pose(std::istream& in) {
  Pose pose;
  for (Eigen::Index row = 0; row < 3; ++row) {
    in >> pose.rotation(row, 0) >> pose.rotation(row, 1) >> pose.rotation(row, 2);
  }
  in >> pose.position[0] >> pose.position[1] >> pose.position[2];
  return pose;
}

inline Vector read_vector(std::istream& in) {
  std::vector<double> values;
  for (double value = 0.0; in >> value;) {
    values.push_back(value);
  }
  return Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

inline Setup read(const std::string& file) {
  Setup setup;
  const std::map<std::string, Vector*> vectors{
      {"start", &setup.start},       {"lower", &setup.lower},   {"upper", &setup.upper},
      {"velocity", &setup.velocity}, {"effort", &setup.effort}, {"rotor_inertia", &setup.rotor_inertia}};
  const std::map<std::string, double*> scalars{{"dt", &setup.dt},
                                               {"duration", &setup.duration},
                                               {"gain", &setup.gain},
                                               {"posture_gain", &setup.posture_gain},
                                               {"limit_gain", &setup.limit_gain}};
  const std::map<std::string, std::string*> texts{
      {"urdf", &setup.urdf}, {"config", &setup.config}, {"mode", &setup.mode}};
  std::ifstream lines(file);
  if (!lines) {
    throw std::runtime_error("cannot read " + file);
  }
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string key;
    in >> key;
    if (vectors.count(key) != 0) {
      *vectors.at(key) = read_vector(in);
    } else if (scalars.count(key) != 0) {
      in >> *scalars.at(key);
    } else if (texts.count(key) != 0) {
      in >> *texts.at(key);
    } else if (key == "repeats") {
      in >> setup.repeats;
    } else if (key == "tip") {
      setup.tip = read_pose(in);
    } else if (key == "goal") {
      std::string name;
      in >> name;
      setup.goals.emplace_back(name, read_pose(in));
    } else if (key == "joint") {
      Joint joint;
      std::string kind;
      in >> joint.name >> kind >> joint.axis[0] >> joint.axis[1] >> joint.axis[2];
      joint.prismatic = kind == "prismatic";
      joint.placement = read_pose(in);
      setup.joints.push_back(joint);
    } else {
      throw std::runtime_error("unknown key " + key);
    }
  }
  return setup;
}

inline Pose forward(const Setup& setup, const Vector& q) {
  Pose pose;
  const auto append = [&pose](const Matrix3& rotation, const Vector3& position) {
    pose.position += pose.rotation * position;
    pose.rotation = (pose.rotation * rotation).eval();
  };
  for (std::size_t i = 0; i < setup.joints.size(); ++i) {
    const Joint& joint = setup.joints[i];
    const double at = q[static_cast<Eigen::Index>(i)];
    append(joint.placement.rotation, joint.placement.position);
    if (joint.prismatic) {
      append(Matrix3::Identity(), joint.axis * at);
    } else {
      append(Eigen::AngleAxisd(at, joint.axis).matrix(), Vector3::Zero());
    }
  }
  append(setup.tip.rotation, setup.tip.position);
  return pose;
}

inline double rotation_angle(const Matrix3& r) {
  const Vector3 sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(sine.norm(), r.trace() - 1.0);
}

/// The goal's rotation, or one on the way that is so far from here [rad].
inline Matrix3 towards(const Matrix3& here, const Matrix3& goal, double at_most) {
  const Eigen::AngleAxisd error(Matrix3(here.transpose() * goal));
  return error.angle() <= at_most ? goal : here * Eigen::AngleAxisd(at_most, error.axis()).matrix();
}

/// What joints do under torques; empty in velocity mode.
using Plant = std::function<Vector(const Vector& q, const Vector& v, const Vector& tau)>;

struct Run {
  std::string goal;
  double dt = 0.0;
  int cycles = 0;
  int failures = 0;
  bool gave_up = false;
  double violation = -HUGE_VAL;  // of limits [rad or m], negative: distance kept
  double speed_excess = -1.0;    // over the bounds [share]
  double command_excess = -1.0;
  double jump = 0.0;  // of the command from cycle to cycle [share of its bound]
  double position_error = 0.0;
  double orientation_error = 0.0;
  std::vector<double> times_us{};
};

/// One run from rest towards a goal. The peer has start(goal, dt); prepare(q), what its user has to compute for it, not
/// timed; and bool command(q, v, u), which is timed and covers its kinematics. False: no command.
template <typename Peer>
Run run(Peer& peer, const Setup& setup, const std::pair<std::string, Pose>& goal, double dt,
        const Plant& plant) {
  Run result{.goal = goal.first, .dt = dt};
  const int cycles = static_cast<int>(std::lround(setup.duration / dt));
  const Eigen::Index n = setup.start.size();
  result.times_us.reserve(static_cast<std::size_t>(cycles));
  Vector q = setup.start, v = Vector::Zero(n), u = Vector::Zero(n), last = Vector::Zero(n);
  bool answered_last = false;
  int failing = 0;
  peer.start(goal.second, dt);
  while (result.cycles < cycles && failing * dt < give_up_s) {
    peer.prepare(q);
    const auto begin = std::chrono::steady_clock::now();
    const bool answered = peer.command(q, v, u) && u.allFinite();
    result.times_us.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    if (!answered) {
      u.setZero();
      ++result.failures;
    }
    failing = answered ? 0 : failing + 1;
    if (!setup.torque()) {
      v = u;
      q += v * dt;
    } else {
      const Vector a = answered ? plant(q, v, u) : Vector((-v / dt).cwiseMax(-braking).cwiseMin(braking));
      q += v * dt + a * (dt * dt / 2);
      v += a * dt;
    }
    const auto largest = [](const auto& values) { return values.maxCoeff(); };
    result.violation = std::max(result.violation, largest((q - setup.upper).cwiseMax(setup.lower - q)));
    result.speed_excess =
        std::max(result.speed_excess, largest(v.cwiseAbs().cwiseQuotient(setup.velocity)) - 1.0);
    result.command_excess =
        std::max(result.command_excess, largest(u.cwiseAbs().cwiseQuotient(setup.bounds())) - 1.0);
    if (answered && answered_last) {  // a failure is counted as such
      result.jump = std::max(result.jump, largest((u - last).cwiseAbs().cwiseQuotient(setup.bounds())));
    }
    last = u;
    answered_last = answered;
    ++result.cycles;
  }
  result.gave_up = result.cycles < cycles;
  const Pose there = forward(setup, q);
  result.position_error = (goal.second.position - there.position).norm();
  result.orientation_error = rotation_angle(there.rotation.transpose() * goal.second.rotation);
  return result;
}

/// As NumPy's percentile.
inline double percentile(std::vector<double>& values, double percent) {
  std::sort(values.begin(), values.end());
  const double place = percent / 100.0 * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

struct About {
  std::string package;
  std::string version;
  std::string priorities;
  std::string settings;
};

inline void print(const About& about, double p50, double p99, const std::vector<Run>& runs) {
  std::printf(
      R"({"package": "%s", "version": "%s", "language": "C++", "priorities": "%s", "settings": "%s", )",
      about.package.c_str(), about.version.c_str(), about.priorities.c_str(), about.settings.c_str());
  std::printf(R"("p50_us": %.9g, "p99_us": %.9g, "runs": [)", p50, p99);
  const char* separator = "";
  for (const Run& run : runs) {
    std::printf(R"(%s{"goal": "%s", "dt": %.9g, "cycles": %d, "failures": %d, "gave_up": %s, )", separator,
                run.goal.c_str(), run.dt, run.cycles, run.failures, run.gave_up ? "true" : "false");
    std::printf(R"("violation": %.9g, "speed_excess": %.9g, "command_excess": %.9g, "jump": %.9g, )",
                run.violation, run.speed_excess, run.command_excess, run.jump);
    std::printf(R"("position_error": %.9g, "orientation_error": %.9g})", run.position_error,
                run.orientation_error);
    separator = ", ";
  }
  std::printf("]}\n");
}

/// All runs of a peer, and the cost of its cycle along those towards the named goals.
template <typename Peer>
void measure(Peer& peer, const Setup& setup, const About& about, const Plant& plant = {}) {
  std::vector<Run> runs;
  std::vector<double> times;
  for (const auto& goal : setup.goals) {
    const bool named = goal.first.rfind("goal_", 0) != 0;
    for (int repeat = 0; repeat < (named ? setup.repeats : 1); ++repeat) {
      Run done = run(peer, setup, goal, setup.dt, plant);
      if (named) {
        times.insert(times.end(), done.times_us.begin(), done.times_us.end());
      }
      if (repeat == 0) {
        runs.push_back(std::move(done));
      }
    }
    if (named) {
      runs.push_back(run(peer, setup, goal, setup.dt / fine, plant));
    }
  }
  const double p50 = percentile(times, 50.0);
  print(about, p50, percentile(times, 99.0), runs);
}

}  // namespace peers
