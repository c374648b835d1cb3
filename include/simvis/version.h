// Which SimVis this is. The build reads the number from here.
#pragma once

#include <string_view>

namespace simvis {

/// "MAJOR.MINOR.PATCH" of the headers that a program or a plug-in is compiled with. Before 1.0 two versions work
/// together when MAJOR and MINOR are equal.
inline constexpr std::string_view kHeaderVersion = "0.1.0";

/// The version of the library that runs, in the same form.
std::string_view version();

}  // namespace simvis
