#include "mujoco_reader.hpp"

namespace tope {
namespace {

double not_negative(const YamlReader& yaml, const std::string& key) {
  const double value = yaml.number(key);
  if (value < 0.0) {
    yaml.fail(key, "must not be negative");
  }
  return value;
}

double not_negative(const YamlReader& yaml, const std::string& key, double fallback) {
  return yaml.has(key) ? not_negative(yaml, key) : fallback;
}

SensorOptions read_sensors(const YamlReader& yaml) {
  SensorOptions options;
  static const std::vector<std::string> localisations{"ideal", "odometry"};
  options.localisation = static_cast<SensorOptions::Localisation>(
      choice(yaml, "localisation", yaml.text("localisation", localisations[0]), localisations));
  options.encoder_noise = not_negative(yaml, "encoder_noise", options.encoder_noise);
  options.encoder_step = not_negative(yaml, "encoder_step", options.encoder_step);
  options.localiser_noise = not_negative(yaml, "localiser_noise", options.localiser_noise);
  options.velocity_filter = not_negative(yaml, "velocity_filter", options.velocity_filter);
  options.latency = not_negative(yaml, "latency", options.latency);
  options.seed = static_cast<std::uint64_t>(yaml.integer("seed", static_cast<int>(options.seed)));
  yaml.finish();
  return options;
}

/// `at` [s] and `for` [s]; without `for` to the end.
Interval read_interval(const YamlReader& yaml) {
  Interval interval;
  interval.start = not_negative(yaml, "at");
  interval.duration = yaml.positive("for", interval.duration);
  return interval;
}

MujocoFaults read_faults(const YamlReader& yaml) {
  MujocoFaults faults;
  if (const auto grip = yaml.optional_map("lost_grip")) {
    static const std::vector<std::string> wheels{"front_left", "front_right", "back_left", "back_right"};
    faults.lost_grip_wheel = static_cast<int>(choice(*grip, "wheel", grip->text("wheel"), wheels));
    faults.lost_grip = read_interval(*grip);
    grip->finish();
  }
  if (const auto stall = yaml.optional_map("stall")) {
    faults.stall = read_interval(*stall);
    stall->finish();
  }
  if (const auto payload = yaml.optional_map("payload")) {
    faults.payload_mass = payload->positive("mass");
    faults.payload = read_interval(*payload);
    payload->finish();
  }
  if (const auto obstacle = yaml.optional_map("obstacle")) {
    faults.obstacle_velocity = obstacle->number("velocity");
    faults.obstacle = read_interval(*obstacle);
    obstacle->finish();
  }
  yaml.finish();
  return faults;
}

}  // namespace

MujocoOptions read_mujoco(const YamlReader& yaml) {
  MujocoOptions options;
  options.model = yaml.path("model");
  if (!std::filesystem::is_regular_file(options.model)) {
    yaml.fail("model", options.model.string() + ": no such file");
  }
  if (const auto sensors = yaml.optional_map("sensors")) {
    options.sensors = read_sensors(*sensors);
  }
  if (const auto faults = yaml.optional_map("faults")) {
    options.faults = read_faults(*faults);
  }
  yaml.finish();
  return options;
}

}  // namespace tope
