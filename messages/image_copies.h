// Copies of images whose memory is used again.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <simvis/image.h>

namespace simvis::ros {

/// A copy lives until its last owner, which may be another thread, lets it go; its memory then waits for the next copy.
/// New memory of this size costs more than the copy itself, because the system clears it page by page.
/// Threads  copy() by one thread at a time; copies may be let go by any thread, also after the end of this object.
class ImageCopies {
 public:
  std::shared_ptr<const simvis::Image> copy(const simvis::Image& image) {
    std::unique_ptr<simvis::Image> own = take(image.pixels.size());
    *own = image;
    return {own.release(), [unused = unused_](simvis::Image* done) {
              const std::lock_guard lock(unused->mutex);
              unused->images.emplace_back(done);
            }};
  }

 private:
  struct Unused {
    std::mutex mutex;
    std::vector<std::unique_ptr<simvis::Image>> images;
  };

  std::unique_ptr<simvis::Image> take(std::size_t size) const {
    const std::lock_guard lock(unused_->mutex);
    const auto found =
        std::ranges::find_if(unused_->images, [&](const auto& each) { return each->pixels.capacity() == size; });
    if (found == unused_->images.end()) return std::make_unique<simvis::Image>();
    std::unique_ptr<simvis::Image> own = std::move(*found);
    unused_->images.erase(found);
    return own;
  }

  std::shared_ptr<Unused> unused_ = std::make_shared<Unused>();
};

}  // namespace simvis::ros
