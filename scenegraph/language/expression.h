// Arithmetic in scene files: the text between "${" and "}".
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace simvis {

/// Variables by name.
using VariableValues = std::map<std::string, double, std::less<>>;

/// Evaluates numbers, variables, pi, + - * / ( ), and the functions sin cos tan asin acos atan atan2 (degrees), sqrt,
/// abs, floor, round, mod, min and max. Sets `value` and returns an empty string; if the text is no expression, names
/// an unknown variable, divides by zero or has a result that is not finite, returns what is wrong.
std::string evaluate(std::string_view text, const VariableValues& variables, double& value);

/// Replaces each "${EXPRESSION}" in `text` by the shortest text that reads back to its value. Returns what is wrong, or
/// an empty string.
std::string substitute(std::string& text, const VariableValues& variables);

/// Whether a variable may have this name: letters, digits and '_', no digit in front, and not pi or a function's name.
bool is_variable_name(std::string_view name);

}  // namespace simvis
