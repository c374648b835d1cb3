// Numbers of a measurement, which do not change while a copy of them exists.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

namespace simvis {

/// Numbers that can only be read. A copy shares the memory and costs no more than a counter.
///
/// Threads  as a value: arrays that share memory may be read, copied and destroyed in different threads, while one of
///          them is written to.
template <typename T>
class SharedNumbers {
 public:
  SharedNumbers() = default;  ///< no numbers

  std::size_t size() const { return numbers().size(); }                   ///< number of numbers
  bool empty() const { return numbers().empty(); }                        ///< whether there are none
  const T* data() const { return numbers().data(); }                      ///< valid as long as any copy has them
  const T& operator[](std::size_t i) const { return numbers()[i]; }       ///< `i` must be below size()
  const T& front() const { return numbers().front(); }                    ///< there must be one
  const T& back() const { return numbers().back(); }                      ///< there must be one
  const T* begin() const { return data(); }                               ///< of the numbers in order
  const T* end() const { return data() + size(); }                        ///< behind the last
  const std::vector<T>& numbers() const { return now_ ? *now_ : kNone; }  ///< all of them
  /// As numbers().
  operator const std::vector<T>&() const { return numbers(); }  // NOLINT(google-explicit-constructor): as numbers()

  /// Whether the numbers are equal.
  friend bool operator==(const SharedNumbers& a, const SharedNumbers& b) { return a.numbers() == b.numbers(); }
  /// Whether the numbers are these.
  friend bool operator==(const SharedNumbers& a, const std::vector<T>& b) { return a.numbers() == b; }

 protected:
  /// A counted vector. std::shared_ptr does not say in a synchronized way that there is no other holder.
  class Block {
   public:
    Block() = default;  ///< no vector
    /// Holds these numbers alone.
    explicit Block(std::vector<T> numbers) : counted_(new Counted{{1}, std::move(numbers)}) {}
    /// Shares the vector.
    Block(const Block& other) : counted_(other.counted_) {
      if (counted_ != nullptr) counted_->holders.fetch_add(1, std::memory_order_relaxed);
    }
    /// Takes the vector.
    Block(Block&& other) noexcept : counted_(std::exchange(other.counted_, nullptr)) {}
    /// Takes the vector, and gives its own back.
    Block& operator=(Block other) noexcept {
      std::swap(counted_, other.counted_);
      return *this;
    }
    ~Block() {
      if (counted_ != nullptr && counted_->holders.fetch_sub(1, std::memory_order_acq_rel) == 1) delete counted_;
    }
    explicit operator bool() const { return counted_ != nullptr; }     ///< whether there is a vector
    std::vector<T>& operator*() const { return counted_->numbers; }    ///< the vector, which must be there
    std::vector<T>* operator->() const { return &counted_->numbers; }  ///< the same
    /// Whether another block holds the vector, which must be there.
    bool is_shared() const { return counted_->holders.load(std::memory_order_acquire) > 1; }

   private:
    struct Counted {
      std::atomic<std::uint32_t> holders;
      std::vector<T> numbers;
    };
    Counted* counted_ = nullptr;
  };

  /// The numbers of a block.
  explicit SharedNumbers(Block now) : now_(std::move(now)) {}

  Block now_;  ///< none: no numbers

 private:
  static inline const std::vector<T> kNone{};
};

/// An array of numbers. A copy costs no more than a counter: it shares the memory, and keeps the numbers that the
/// original has now. A write to an array that has copies goes to other memory; memory that no copy holds any more
/// is used again for it, so that a sensor whose measurements are held for some frames allocates nothing in later ones.
template <typename T>
class SharedArray : public SharedNumbers<T> {
 public:
  SharedArray() = default;  ///< no numbers
  /// These numbers.
  SharedArray(std::vector<T> numbers)  // NOLINT(google-explicit-constructor): the same numbers
      : SharedNumbers<T>(Block(std::move(numbers))) {}
  /// These numbers.
  SharedArray(std::initializer_list<T> numbers) : SharedArray(std::vector<T>(numbers)) {}
  /// Shares the numbers.
  SharedArray(const SharedArray& other) : SharedNumbers<T>(other) {}
  /// Takes the memory.
  SharedArray(SharedArray&&) noexcept = default;
  /// Shares the numbers of the other array.
  SharedArray& operator=(const SharedArray& other) {
    now_ = other.now_;
    return *this;
  }
  /// Takes the memory of the other array.
  SharedArray& operator=(SharedArray&&) noexcept = default;
  ~SharedArray() = default;

  /// All numbers, to change some: numbers that a copy holds are copied first. Valid until this array is copied.
  std::vector<T>& edit() {
    if (now_ && now_.is_shared()) {
      const std::vector<T>& shared = *now_;
      now_ = Block(shared);
    }
    return own();
  }

  /// As edit(), to replace all numbers: if a copy holds them, there are others in their place, mostly as many.
  std::vector<T>& overwrite() {
    if (now_ && now_.is_shared()) {
      const std::size_t size = this->size();
      before_.push_back(std::move(now_));
      now_ = take_spare();
      own().resize(size);
    } else if (before_.size() > 1) {
      if (Block spare = take_spare()) before_.push_back(std::move(spare));
    }
    return own();
  }

  /// Bytes that this array holds besides its present numbers: memory of earlier ones, of at most one array that no copy
  /// holds any more.
  std::size_t held_bytes() const {
    std::size_t bytes = 0;
    for (const Block& each : before_) bytes += each->size() * sizeof(T);
    return bytes;
  }

 private:
  using Block = typename SharedNumbers<T>::Block;
  using SharedNumbers<T>::now_;

  std::vector<T>& own() {
    if (!now_) now_ = Block(std::vector<T>());
    return *now_;
  }

  // Of the earlier numbers, those that no copy holds any more; one of them is taken and the others are freed.
  Block take_spare() {
    Block spare;
    std::erase_if(before_, [&](Block& each) {
      if (each.is_shared()) return false;
      spare = std::move(each);
      return true;
    });
    return spare;
  }

  std::vector<Block> before_;  // that copies have held
};

}  // namespace simvis
