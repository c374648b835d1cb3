// SHA-256, which tells whether a file or a message type is the same as another time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/program_api.h"

namespace simvis {

/// The SHA-256 of a file's content as 64 digits in lower case, as the program sha256sum prints it. Throws as InputFile,
/// and std::runtime_error where libcrypto has no SHA-256.
SIMVIS_PROGRAM_API std::string sha256_of(const std::filesystem::path& file);

/// The same of these bytes.
std::string sha256_of_text(std::string_view text);

}  // namespace simvis
