#include "import/programs/inventor/inventor_pictures.h"

#include <Inventor/SoFullPath.h>
#include <Inventor/VRMLnodes/SoVRMLImageTexture.h>
#include <Inventor/actions/SoSearchAction.h>
#include <Inventor/nodes/SoTexture2.h>
#include <stb_image.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/mesh/picture_search.h"
#include "import/programs/decode/any_picture.h"

namespace simvis {
namespace {

// Grey pictures have one or two components.
int components_of(const Bytes& file, const Texture& picture) {
  int width = 0, height = 0, components = 0;
  if (stbi_info_from_memory(file.data(), static_cast<int>(file.size()), &width, &height, &components) != 0) {
    return components;
  }
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i] != 255) return 4;
  }
  return 3;
}

// Coin's rows begin at the bottom.
void set_image(const Texture& picture, int components, SbImage& image) {
  std::vector<unsigned char> pixels;
  pixels.reserve(picture.rgba.size());
  for (std::size_t y = picture.height; y-- > 0;) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const std::uint8_t* const rgba = picture.rgba.data() + (y * picture.width + x) * 4;
      for (int c = 0; c < (components <= 2 ? 1 : 3); ++c) pixels.push_back(rgba[c]);
      if (components % 2 == 0) pixels.push_back(rgba[3]);
    }
  }
  image.setValue(SbVec2s(static_cast<short>(picture.width), static_cast<short>(picture.height)), components,
                 pixels.data());
}

// Coin shows the children that it hides, such as those of VRML shapes, to a caller that casts the path to SoFullPath, a
// class that the path is not of.
__attribute__((no_sanitize("vptr"))) SoNode* tail_of(const SoPath& path) {
  return static_cast<const SoFullPath&>(path).getTail();
}

template <class Node>
std::vector<Node*> nodes_below(SoNode& root) {
  SoSearchAction search;
  search.setType(Node::getClassTypeId());
  search.setInterest(SoSearchAction::ALL);
  search.setSearchingAll(TRUE);
  search.apply(&root);
  std::vector<Node*> nodes;
  for (int i = 0; i < search.getPaths().getLength(); ++i) {
    auto* const node = static_cast<Node*>(tail_of(*search.getPaths()[i]));
    if (std::ranges::find(nodes, node) == nodes.end()) nodes.push_back(node);
  }
  return nodes;
}

}  // namespace

void InventorPictures::attach() { SbImage::addReadImageCB(read, this); }

SbBool InventorPictures::read(const SbString& name, SbImage* image, void* self) {
  const std::filesystem::path file(name.getString());
  try {
    if (!is_readable(file) || !is_input_file(file)) return FALSE;  // find_missing() searches for it
    const Bytes bytes = read_whole_file(file);
    const Texture picture = decode_any_picture(bytes, file.string() + ": the picture");
    set_image(picture, components_of(bytes, picture), *image);
    return TRUE;
  } catch (const InputError& e) {
    static_cast<InventorPictures*>(self)->broken_.push_back(file.filename().string());
    static_cast<InventorPictures*>(self)->warnings_.push_back(
        std::string("the material's colour replaces a picture, ") + e.what());
    return FALSE;
  } catch (...) {
    static_cast<InventorPictures*>(self)->fault_ = std::current_exception();
    return FALSE;
  }
}

template <class SetFile>
void InventorPictures::find_one(const std::string& name, const std::filesystem::path& file, SetFile set_file) {
  std::erase_if(unread_, [&](const std::string& message) { return message.find(name) != std::string::npos; });
  const PictureSearch search = find_picture(name, file);
  const std::string subject = "picture " + in_quotes(name) + " ";
  if (!search.file) {
    warnings_.push_back(subject + search.not_found());
    set_file("");  // with a name, Coin would put a white picture in its place
  } else if (std::ranges::find(broken_, search.file->filename().string()) == broken_.end()) {
    if (search.elsewhere) warnings_.push_back(subject + "is taken from " + search.file->string());
    set_file(std::filesystem::absolute(*search.file));
  } else {
    set_file("");
  }
}

void InventorPictures::find_missing(SoNode& root, const std::filesystem::path& file) {
  for (SoTexture2* const texture : nodes_below<SoTexture2>(root)) {
    SbVec2s size;
    int components = 0;
    const std::string name = texture->filename.getValue().getString();
    if (name.empty() || texture->image.getValue(size, components) != nullptr) continue;
    find_one(name, file, [&](const std::filesystem::path& found) { texture->filename.setValue(found.c_str()); });
  }
  for (SoVRMLImageTexture* const texture : nodes_below<SoVRMLImageTexture>(root)) {
    SbVec2s size;
    int components = 0;
    const bool has_image = texture->getImage() != nullptr && texture->getImage()->getValue(size, components) != nullptr;
    if (has_image || texture->url.getNum() == 0) continue;
    find_one(texture->url[0].getString(), file,
             [&](const std::filesystem::path& found) { texture->url.setValue(found.c_str()); });
  }
}

void InventorPictures::rethrow_fault() const {
  if (fault_) std::rethrow_exception(fault_);
}

std::vector<std::string> InventorPictures::release_warnings() {
  std::ranges::move(unread_, std::back_inserter(warnings_));
  return std::move(warnings_);
}

}  // namespace simvis
