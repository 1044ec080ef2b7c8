#include "urdf_loader.hpp"

#include <tope/common/error.hpp>

#include <urdf_parser/urdf_parser.h>

#include <console_bridge/console.h>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

namespace tope {
namespace {

/// Collects what the parser would print, so that it can be part of the exception.
class ParserMessages : public console_bridge::OutputHandler {
 public:
  ParserMessages() { console_bridge::useOutputHandler(this); }
  ~ParserMessages() override { console_bridge::restorePreviousOutputHandler(); }
  ParserMessages(const ParserMessages&) = delete;
  ParserMessages& operator=(const ParserMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
      text_ += (text_.empty() ? "" : "; ") + text;
    }
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string read(const std::filesystem::path& file) {
  const std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw ConfigError(file.string() + ": no such URDF file, or it cannot be read");
  }
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

void make_revolute(urdf::Joint& joint) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!joint.limits) {
    joint.limits = std::make_shared<urdf::JointLimits>();
    joint.limits->effort = infinity;
    joint.limits->velocity = infinity;
  }
  joint.type = urdf::Joint::REVOLUTE;
  joint.limits->lower = -infinity;
  joint.limits->upper = infinity;
}

void check_kind(const urdf::Joint& joint, const std::string& file) {
  const std::string where = file + ": joint '" + joint.name + "': ";
  if (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR) {
    throw ConfigError(where +
                      "floating and planar joints are not supported inside the URDF; let its child be the "
                      "root and say 'base: {type: "
                      "planar, ...}' (or floating) in the robot's YAML file");
  }
}

}  // namespace

urdf::ModelInterfaceSharedPtr load_urdf(const std::filesystem::path& file) {
  const std::string content = read(file);
  const ParserMessages messages;
  urdf::ModelInterfaceSharedPtr tree = urdf::parseURDF(content);
  if (!tree) {
    throw ConfigError(file.string() + ": malformed URDF: " +
                      (messages.text().empty() ? "the parser gave no reason" : messages.text()));
  }
  for (auto& [name, joint] : tree->joints_) {
    check_kind(*joint, file.string());
    if (joint->type == urdf::Joint::CONTINUOUS) {
      make_revolute(*joint);
    }
  }
  return tree;
}

}  // namespace tope
