// Whose fault it is that a file cannot be read: that of its name or content, or that of the machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace simvis {

/// Whether the number of an error of the operating system is about the file that was named: it is not there, may not be
/// read or is of the wrong kind. All others are about the machine: a disk that fails or is full, too many open files,
/// no memory. Unknown numbers count as the machine's, because only faults of files may be skipped.
bool is_fault_of_file(int error);

/// Throws InputError if is_fault_of_file(error), otherwise MachineError: "FILE: error: WHAT: REASON".
[[noreturn]] void throw_read_error(const std::filesystem::path& file, const std::string& what, int error);

/// Throws InputError naming the file if its text is a pointer of Git LFS, which stands where the file itself is not
/// fetched. `text` is its beginning: kLfsPointerStart.size() bytes, or the whole file.
void refuse_lfs_pointer(const std::filesystem::path& file, std::string_view text);

/// The first line of a pointer, and its largest size in bytes, as the Git LFS specification says.
inline constexpr std::string_view kLfsPointerStart = "version https://git-lfs.github.com/spec/";
inline constexpr std::size_t kLargestLfsPointer = 1024;

/// Whether anything has this name; false within the limit of a request (read_fence.h) for what lies outside. Throws
/// MachineError if the machine cannot say.
bool is_there(const std::filesystem::path& path);

/// Whether there is a regular file of this name, behind symbolic links. Throws like is_there().
bool is_input_file(const std::filesystem::path& file);

/// The same for a folder.
bool is_input_folder(const std::filesystem::path& folder);

}  // namespace simvis
