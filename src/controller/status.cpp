#include <tope/controller/status.hpp>

#include <sstream>

namespace tope {
namespace {

std::string joint_name(const Robot& robot, int joint) {
  return joint < 0 ? "a joint" : robot.joint_names()[static_cast<std::size_t>(joint)];
}

std::string pair_name(const std::vector<std::string>& pairs, int pair) {
  return pair < 0 || pair >= static_cast<int>(pairs.size()) ? "a pair"
                                                            : pairs[static_cast<std::size_t>(pair)];
}

std::string sentence(Event event, const Status& status, const Robot& robot,
                     const std::vector<std::string>& pairs) {
  std::ostringstream text;
  switch (event) {
    case Event::limit:
      text << "The limit of " << joint_name(robot, status.limit_joint) << " shapes the command.";
      break;
    case Event::scaled:
      text << "The tasks' share is scaled to " << status.scale << " by the bound of "
           << joint_name(robot, status.bound_joint) << ".";
      break;
    case Event::clipped:
      text << "What the limits ask of " << joint_name(robot, status.bound_joint)
           << " is beyond its bound; clipped.";
      break;
    case Event::singular:
      text << "A task direction is nearly lost to a singularity or a higher level; it is damped.";
      break;
    case Event::beyond:
      text << joint_name(robot, status.beyond_joint) << " is beyond its limit and is led back.";
      break;
    case Event::avoiding:
      text << "The distance of " << pair_name(pairs, status.avoiding_pair) << " shapes the command.";
      break;
    case Event::too_near:
      text << "The distance of " << pair_name(pairs, status.near_pair)
           << " is below its margin; it is led back.";
      break;
    case Event::held:
      text << "A limit, a bound or a higher level holds back a task with a predefined time, which does not "
              "hold.";
      break;
    case Event::near_flip:
      text << "An orientation error is within 0.05 rad of pi, where its direction flips.";
      break;
    case Event::cut_off:
      text << "A solver reached its iteration bound; limits hold, tasks are served less well.";
      break;
    case Event::bad_input:
      text << "The state or time is not finite or has the wrong size; no motion is commanded.";
      break;
  }
  return text.str();
}

}  // namespace

std::string_view to_string(Event event) {
  constexpr std::array<std::string_view, all_events.size()> names{
      "limit",    "scaled", "clipped",   "singular", "beyond",   "avoiding",
      "too_near", "held",   "near_flip", "cut_off",  "bad_input"};
  return names[static_cast<std::size_t>(event)];
}

std::string event_names(const Status& status) {
  std::string names;
  for (const Event event : all_events) {
    if (status.has(event)) {
      names += names.empty() ? "" : "|";
      names += to_string(event);
    }
  }
  return names.empty() ? "ok" : names;
}

std::string describe(const Status& status, const Robot& robot, const std::vector<std::string>& pairs) {
  std::string text;
  for (const Event event : all_events) {
    if (status.has(event)) {
      text += (text.empty() ? "" : " ") + sentence(event, status, robot, pairs);
    }
  }
  return text.empty() ? "ok" : text;
}

}  // namespace tope
