#pragma once

namespace tope {

/// Task::near_flip(): closer to pi than this, the direction of a rotation error is about to flip [rad].
inline constexpr double kNearFlip = 0.05;

}  // namespace tope
