#include <tope/common/error.hpp>
#include <tope/robot/package_path.hpp>

#include <pinocchio/parsers/utils.hpp>

#include <dlfcn.h>
#include <string>
#include <string_view>
#include <vector>

namespace tope {
namespace {

constexpr std::string_view scheme = "package:";

/// Folders that hold packages.
std::vector<std::string> package_folders() {
  std::vector<std::string> folders = pinocchio::rosPaths();
  std::erase(folders, "");
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&pinocchio::rosPaths), &library) != 0) {
    const auto file = std::filesystem::weakly_canonical(library.dli_fname);
    folders.push_back(file.parent_path().parent_path() / "share");  // of prefix/lib/libpinocchio_parsers.so
  }
  return folders;
}

}  // namespace

std::filesystem::path package_path(const std::filesystem::path& path) {
  if (path.empty() || *path.begin() != scheme) {
    return path;
  }
  const std::filesystem::path relative = path.lexically_normal().lexically_relative(scheme);
  const std::filesystem::path package = *relative.begin();
  std::string searched;
  for (const std::filesystem::path folder : package_folders()) {
    if (std::filesystem::is_directory(folder / package)) {
      return folder / relative;
    }
    searched += (searched.empty() ? "" : ", ") + folder.string();
  }
  throw ConfigError(path.string() + ": no package '" + package.string() + "' in " + searched +
                    "; install it, or add the folder that holds it to ROS_PACKAGE_PATH");
}

}  // namespace tope
