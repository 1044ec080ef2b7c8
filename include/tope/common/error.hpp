#pragma once

#include <stdexcept>
#include <string>

namespace tope {

/// Root of every exception the library throws. None is thrown by an update path.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bad input found while something is built: a file, an option, a name, a size. The message says where,
/// what the value is and what would be right.
class ConfigError : public Error {
 public:
  using Error::Error;
};

}  // namespace tope
