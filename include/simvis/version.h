// The version of SimVis. The build reads the number from this file.
#pragma once

#include <string_view>

#include <simvis/export.h>

namespace simvis {

/// "MAJOR.MINOR.PATCH" of the headers that a program or a plug-in is compiled with. Before 1.0 two versions are
/// compatible if MAJOR and MINOR are equal.
inline constexpr std::string_view kHeaderVersion = "0.2.0";

/// The version of the running library, in the same form. The text is static.
SIMVIS_API std::string_view version();

}  // namespace simvis
