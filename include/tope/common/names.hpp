#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tope {

/// The candidate spelled most like `name` (Levenshtein distance), or an empty view when none is near.
std::string_view nearest_name(std::string_view name, std::span<const std::string> candidates);

/// "; did you mean 'x'?" when a candidate is near, otherwise "; known: a, b, c".
std::string name_hint(std::string_view name, std::span<const std::string> candidates);

}  // namespace tope
