// Reads the pictures of Inventor and VRML files, and finds those that Coin does not find.
#pragma once

#include <Inventor/SbImage.h>
#include <Inventor/nodes/SoNode.h>

#include <exception>
#include <filesystem>
#include <string>
#include <vector>

namespace simvis {

class InventorPictures {
 public:
  /// Coin reads pictures by this object from now on, which must live as long as Coin is used.
  void attach();

  /// Coin's message that it could not read a picture. It gives neither the reason nor the places.
  void hear(const std::string& message) { unread_.push_back(message); }

  /// Searches for the pictures of all textures below `root` that have none yet, as find_picture() does.
  void find_missing(SoNode& root, const std::filesystem::path& file);

  /// Throws the exception that ended the reading of a picture, unless the picture is broken.
  void rethrow_fault() const;

  /// One text for each picture that is missing, cannot be read or was found elsewhere.
  std::vector<std::string> release_warnings();

 private:
  static SbBool read(const SbString& name, SbImage* image, void* self);
  template <class SetFile>
  void find_one(const std::string& name, const std::filesystem::path& file, SetFile set_file);

  std::vector<std::string> unread_, warnings_, broken_;
  std::exception_ptr fault_;
};

}  // namespace simvis
