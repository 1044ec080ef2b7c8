#pragma once

#include <filesystem>

namespace tope {

/// The file that "package://NAME/REST" names: REST inside the folder NAME of ROS_PACKAGE_PATH, of the share/ of
/// AMENT_PREFIX_PATH, or of the share/ beside the Pinocchio library in use, where packages from PyPI are. Any other
/// path stays as it is. Errors: ConfigError when no such package is found, with the folders that were searched.
std::filesystem::path package_path(const std::filesystem::path& path);

}  // namespace tope
