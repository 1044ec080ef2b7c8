#pragma once

#include <tope/robot/robot.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tope {

/// What acted in one cycle. Several may act at once.
enum class Event : std::uint8_t {
  limit,     ///< a joint limit shapes the command
  scaled,    ///< the tasks' share was scaled down to keep a bound
  clipped,   ///< what the limits ask for is beyond a bound by itself, and was clipped
  singular,  ///< a task direction is nearly lost, and was damped
  beyond,    ///< a joint is beyond its limit, and is led back
  avoiding,  ///< a distance to keep shapes the command
  too_near,  ///< a distance is below its margin, and is led back
  held,  ///< a limit, a bound or a higher level holds back a task with a promised time: the promise is void
  near_flip,  ///< an orientation error is within 0.05 rad of pi, where its direction flips
  cut_off,    ///< a solver reached its iteration bound: limits hold, tasks are served less well
  bad_input,  ///< the state or time is not finite or has the wrong size: no motion commanded, nothing changed
              ///< inside
};

inline constexpr std::array all_events{Event::limit,     Event::scaled,   Event::clipped,  Event::singular,
                                       Event::beyond,    Event::avoiding, Event::too_near, Event::held,
                                       Event::near_flip, Event::cut_off,  Event::bad_input};

/// Short name, as in the log: "limit", "scaled", ...
std::string_view to_string(Event event);

/// Result of one cycle: plain data, no allocation.
struct Status {
  std::uint32_t events = 0;  ///< set of Event
  int limit_joint = -1;      ///< joint whose limit is most active
  int bound_joint = -1;      ///< joint whose bound scaled or clipped the command
  int beyond_joint = -1;     ///< joint furthest beyond its limit
  int avoiding_pair = -1;    ///< pair whose distance shapes the command most
  int near_pair = -1;        ///< pair furthest inside its margin
  double scale = 1.0;        ///< s in [0, 1] of the tasks' share
  int laws = 0;              ///< laws evaluated

  bool ok() const { return events == 0; }
  bool has(Event event) const { return (events & bit(event)) != 0; }
  void add(Event event) { events |= bit(event); }

  static constexpr std::uint32_t bit(Event event) { return 1U << static_cast<unsigned>(event); }
};

/// "ok" or the names of the events, joined by '|'.
std::string event_names(const Status& status);

/// One sentence for each event, with the names of joints and, from CollisionLimits::names(), of pairs.
std::string describe(const Status& status, const Robot& robot, const std::vector<std::string>& pairs = {});

}  // namespace tope
