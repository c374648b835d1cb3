// A pool that holds identical content once: equal meshes, textures or materials become one shared object.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <simvis/export.h>
#include <simvis/mesh.h>

namespace simvis {

/// What a picture is read for.
enum class PictureUse : std::uint8_t {
  color,  ///< cameras show it, and nothing else depends on it
  alpha   ///< it also decides where laser beams pass
};

/// A picture that may be read later than the file that names it.
struct PictureSource {
  /// Reads and decodes the picture. Returns nothing and adds a warning if it is not there or broken; throws nothing.
  std::function<std::optional<Texture>(std::vector<std::string>& warnings)> read;
  PictureUse use = PictureUse::color;  ///< only a picture for colour is postponed
  /// Gives a material the look that it has without the picture; may be empty.
  std::function<void(Material&)> without{};
};

/// Finds equal content by hash and then by value. Names are not compared. All pools of a process share content that is
/// equal and has the same name, so that simulations of the same parts hold their meshes and textures once.
///
/// Lifetime  the pool holds weak references: content that has no other owner is released.
/// Threads   one thread at a time; several pools in several threads.
class SIMVIS_API ContentPool {
 public:
  std::shared_ptr<const Mesh> intern(Mesh&& mesh);  ///< the pooled mesh that equals `mesh`; never null
  /// The pooled texture that equals `texture`; never null. Throws MachineError if the textures that live take more than
  /// 4096 MiB together, or as many as the environment variable SIMVIS_PICTURE_MIB says.
  std::shared_ptr<const Texture> intern(Texture&& texture);
  /// The pooled material that equals `material`; never null. Its textures should come from this pool, because textures
  /// of materials are compared by identity.
  std::shared_ptr<const Material> intern(Material&& material);

  /// From now on, picture() postpones pictures for colour, so that a scene without cameras never opens one.
  void postpone_pictures() { postpones_ = true; }
  /// The texture of a picture; null if it cannot be had, after a warning. A postponed picture is a white texel until
  /// read_pictures().
  std::shared_ptr<const Texture> picture(PictureSource source, std::vector<std::string>& warnings);
  /// Whether there are postponed pictures that have not been read.
  bool has_postponed_pictures() const { return !postponed_.empty(); }
  /// Reads the postponed pictures and returns, by the texture that stood for each, what it was meant to be; null if it
  /// cannot be had. Pictures that nothing uses any more are left out.
  std::unordered_map<const Texture*, std::shared_ptr<const Texture>> read_pictures(std::vector<std::string>& warnings);
  /// The material with its pictures as read_pictures() returned them; null if it has none of them.
  std::shared_ptr<const Material> completed(
      const Material& material, const std::unordered_map<const Texture*, std::shared_ptr<const Texture>>& pictures);
  /// Forgets the postponed pictures: every material that used them is completed.
  void forget_postponed_pictures() { postponed_.clear(); }

 private:
  struct Postponed {
    std::shared_ptr<const Texture> stand_in;
    PictureSource source;
  };
  void check_picture_bytes() const;

  bool postpones_ = false;
  std::vector<Postponed> postponed_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Mesh>> meshes_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Texture>> textures_;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const Material>> materials_;
};

}  // namespace simvis
