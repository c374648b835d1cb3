// Which files a thread may read: the state that read_fence.h sets.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace simvis {

using Folders = std::vector<std::filesystem::path>;

/// Which files a thread may read. All folders are canonical: a folder that becomes a symbolic link opens nothing.
struct ReadScope {
  Folders folders;
  /// That of a request of another program, which may change files meanwhile. No fence within opens other folders, no
  /// link leads out of them, and what lies elsewhere is not there.
  std::optional<Folders> limit{};
};

/// The scope of all files in these canonical folders and of no other file, whatever they name.
ReadScope closed_scope(Folders folders);

/// The scope of this thread; empty: it may read all files. For what it reads later, with a fence of its own.
std::optional<ReadScope> read_scope();

/// The same as it is set; null: there is none.
ReadScope* innermost_read_scope();

/// Sets the scope of this thread, which must live as long as it is set; null: all files. Returns the one before.
ReadScope* exchange_read_scope(ReadScope* scope);

/// Whether the file or folder is one of the folders or lies below one.
bool lies_in(const std::filesystem::path& file, const Folders& folders);

/// Where what `descriptor` has open lies, wherever `file`, by which it was opened, leads now. Throws MachineError if
/// the system does not say it.
std::filesystem::path place_of(const std::filesystem::path& file, int descriptor);

}  // namespace simvis
