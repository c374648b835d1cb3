// Which files a part file may name: those in folders that belong to it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "engine/base/read_scope.h"

namespace simvis {

/// The folders whose files this part may name, with all that is below them: the folder in which it lies, its model
/// folder, and the folders of the fence that this thread is within. The model folder is the nearest, at most five
/// folders above the part, that has a file package.xml, manifest.xml or model.config and is not is_shared_folder();
/// without one, the folder above that of the part, unless that is shared. Where the part or a folder is a symbolic
/// link, what it links to counts as well. A file of another user marks his own folders alone: it must belong to the
/// owner of its folder, to the user or to root.
Folders folders_of_part(const std::filesystem::path& part);

/// Whether files that have nothing to do with each other lie there: the root, the home folder and those above it, and
/// the folder for temporary files.
bool is_shared_folder(const std::filesystem::path& folder);

/// Whether the folder is a ROS package or a Gazebo model, by the files that folders_of_part() looks for.
bool is_model_folder(const std::filesystem::path& folder);

/// While it lives, the thread that made it can read those files alone that lie in one of the folders, or that a
/// symbolic link there leads to in a model folder. Fences are nested; the innermost counts, within the limit of the
/// outer one. What counts is where an opened file lies (InputFile), not where its name led before.
class ReadFence {
 public:
  explicit ReadFence(const Folders& folders);
  explicit ReadFence(ReadScope scope);
  ~ReadFence();
  ReadFence(const ReadFence&) = delete;
  ReadFence& operator=(const ReadFence&) = delete;

 private:
  ReadScope scope_;
  ReadScope* outer_;
};

/// The fence of a part, which must itself be readable: throws as require_readable().
class PartFence : public ReadFence {
 public:
  explicit PartFence(const std::filesystem::path& part);
};

/// The fence of the meshes and pictures of a robot or a world: they may lie anywhere in its package, wheel or
/// repository. To the folders of the innermost fence it adds the nearest folder, from that of the file upwards to a
/// is_shared_folder(), that folders_of_part() takes for a model folder, or that holds pyproject.toml or .git, or that
/// lies beside a folder *.dist-info. Files that are more than data, such as xacro, are read outside of it. Without a
/// fence, all stays open.
class ModelFence {
 public:
  explicit ModelFence(const std::filesystem::path& model);

 private:
  std::optional<ReadFence> fence_;
};

/// While it lives, no fence counts in the thread that made it: for files that SimVis itself looks for.
class ReadOpening {
 public:
  ReadOpening();
  ~ReadOpening();
  ReadOpening(const ReadOpening&) = delete;
  ReadOpening& operator=(const ReadOpening&) = delete;

 private:
  ReadScope* closed_;
};

/// The folders of the innermost fence; empty: there is none.
std::optional<Folders> readable_folders();

/// The folder, such as that of a package which a part refers to, counts from now on in the innermost fence, if there is
/// one.
void admit_folder(const std::filesystem::path& folder);

/// Whether the innermost fence lets the thread read this file, which need not exist: symbolic links count where they
/// lead, also to nothing. True without a fence.
bool is_readable(const std::filesystem::path& file);

/// Where this file lies, without symbolic links; empty: it is not is_readable().
std::optional<std::filesystem::path> readable_place(const std::filesystem::path& file);

/// The same for what `descriptor` has open, wherever `file`, by which it was opened, leads now. Throws MachineError if
/// the system does not say where it lies.
bool is_readable(const std::filesystem::path& file, int descriptor);

/// The path without symbolic links, "." and "..": as far as folders can be looked at, and as written behind that.
std::filesystem::path without_links(const std::filesystem::path& path);

/// What is thrown for a file that the innermost fence does not open.
class OutsideFolders : public InputError {
 public:
  OutsideFolders(std::filesystem::path file, const std::string& message)
      : InputError(message), file_(std::move(file)) {}
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
};

/// Throws OutsideFolders "FILE: error: ..." if not is_readable(), and InputError if its name has a NUL byte.
void require_readable(const std::filesystem::path& file);
[[noreturn]] void refuse_to_read(const std::filesystem::path& file);

}  // namespace simvis
