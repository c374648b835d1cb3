// Which files a part file may name: those in folders that belong to it.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace simvis {

using Folders = std::vector<std::filesystem::path>;

/// The folders whose files this part may name, with all that is below them: the folder in which it lies, its model
/// folder, and the folders of the fence that this thread is within. The model folder is the nearest, at most five
/// folders above the part, that has a file package.xml, manifest.xml or model.config; without one, the folder above
/// that of the part, unless that is_shared_folder(). Where the part or a folder is a symbolic link, what it links to
/// counts as well.
Folders folders_of_part(const std::filesystem::path& part);

/// Whether things that have nothing to do with each other lie there: the root, the home folder and those above it, and
/// the folder for temporary files.
bool is_shared_folder(const std::filesystem::path& folder);

/// Whether the folder is a ROS package or a Gazebo model, by the files that folders_of_part() looks for.
bool is_model_folder(const std::filesystem::path& folder);

/// While it lives, the thread that made it can read those files alone that lie in one of the folders, or that a
/// symbolic link there leads to in a model folder. Fences are nested; the innermost counts.
class ReadFence {
 public:
  explicit ReadFence(const Folders& folders);
  ~ReadFence();
  ReadFence(const ReadFence&) = delete;
  ReadFence& operator=(const ReadFence&) = delete;

 private:
  friend class ReadOpening;
  friend void admit_folder(const std::filesystem::path& folder);
  friend bool is_readable(const std::filesystem::path& file);
  friend std::optional<Folders> readable_folders();
  ReadFence* outer_;
  Folders folders_;  // canonical
};

/// The fence of a part, which must itself be readable: throws as require_readable().
class PartFence : public ReadFence {
 public:
  explicit PartFence(const std::filesystem::path& part);
};

/// While it lives, no fence counts in the thread that made it: for files that SimVis itself looks for.
class ReadOpening {
 public:
  ReadOpening();
  ~ReadOpening();
  ReadOpening(const ReadOpening&) = delete;
  ReadOpening& operator=(const ReadOpening&) = delete;

 private:
  ReadFence* closed_;
};

/// The folders of the innermost fence; empty: there is none. For what the thread reads later, with a fence of its own.
std::optional<Folders> readable_folders();

/// The folder, such as that of a package which a part refers to, counts from now on in the innermost fence, if there is
/// one.
void admit_folder(const std::filesystem::path& folder);

/// Whether the innermost fence lets the thread read this file, which need not exist. True without a fence.
bool is_readable(const std::filesystem::path& file);

/// Throws InputError "FILE: error: ..." if not is_readable(), or if its name has a NUL byte.
void require_readable(const std::filesystem::path& file);

}  // namespace simvis
