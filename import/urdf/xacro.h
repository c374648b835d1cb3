// Expands xacro files with the program xacro.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>

#include "import/model/package_files.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// What the program xacro may use: time of the processor, and memory.
inline constexpr std::chrono::seconds kXacroTime{60};
inline constexpr std::size_t kXacroMemory_bytes = std::size_t{4} << 30;

/// Whether the file is named .xacro or has elements of xacro.
bool is_xacro(const std::filesystem::path& file, const XmlText& text);

/// Starts the program xacro, found in PATH, and returns its output, whose name is "FILE(expanded)". `arguments` are
/// NAME:=VALUE, separated by spaces. xacro finds the packages of `packages`, whether ROS is installed or not; for that,
/// a folder exists in the system's folder of temporary files until the function returns.
/// Throws InputError naming the file if there is no program xacro, if it refuses the file, and for an argument of
/// another form; MachineError if it exceeds a limit.
XmlText expand_xacro(const std::filesystem::path& file, const std::string& arguments, PackageFiles& packages);

}  // namespace simvis
