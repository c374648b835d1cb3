#include "program/datasets/h5_file.h"

#include <string_view>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr std::uint64_t kUndefined = ~std::uint64_t{0}, kSuperblockBytes = 96, kEntryBytes = 40;
// In the B-tree of a group, a leaf has at most 2 kLeafK entries and a node at most 2 kNodeK children.
constexpr std::uint64_t kLeafK = kMaxH5Members / 2, kNodeK = 16, kAlignment = 8;
enum Message : std::uint16_t { kDataspace = 1, kDatatype = 3, kFillValue = 5, kDataLayout = 8, kSymbolTable = 17 };

struct NumberForm {
  std::uint8_t bytes;
  bool is_signed, is_float;
};
NumberForm form_of(H5Type type) {
  constexpr NumberForm kForms[] = {{1, false, false}, {2, false, false}, {4, false, false},
                                   {8, false, false}, {8, true, false},  {4, true, true}};
  return kForms[static_cast<std::size_t>(type)];
}

class Bytes {
 public:
  template <typename... Number>
  void u8(Number... numbers) {
    (add(static_cast<std::uint64_t>(numbers), 1), ...);
  }
  void u16(std::uint64_t number) { add(number, 2); }
  void u32(std::uint64_t number) { add(number, 4); }
  void u64(std::uint64_t number) { add(number, 8); }
  void text(std::string_view text) { bytes_ += text; }
  void align() { bytes_.resize((bytes_.size() + kAlignment - 1) / kAlignment * kAlignment); }
  void fill(std::uint64_t end) { bytes_.resize(end); }
  std::uint64_t size() const { return bytes_.size(); }
  const std::string& all() const { return bytes_; }
  /// All bytes, of which the first are replaced.
  std::string take_behind(const std::string& front) {
    bytes_.replace(0, front.size(), front);
    return std::move(bytes_);
  }

 private:
  void add(std::uint64_t number, int count) {
    for (int i = 0; i < count; ++i) bytes_ += static_cast<char>(number >> 8 * i & 0xff);
  }
  std::string bytes_;
};

/// An object header with its messages.
class ObjectHeader {
 public:
  void add(Message kind, Bytes data) {
    data.align();
    messages_.u16(kind);
    messages_.u16(data.size());
    messages_.u32(0);
    messages_.text(data.all());
    ++count_;
  }
  void append_to(Bytes& file) const {
    file.u8(1, 0);
    file.u16(count_);
    file.u32(1);  // links to it
    file.u32(messages_.size());
    file.u32(0);
    file.text(messages_.all());
  }

 private:
  std::uint16_t count_ = 0;
  Bytes messages_;
};

/// A file from its front. Each part is written behind those that it refers to, and the superblock last.
class Writer {
 public:
  explicit Writer(const std::map<std::string, H5Group>& groups) {
    file_.fill(kSuperblockBytes);
    std::map<std::string, std::uint64_t> top;
    for (const auto& [name, datasets] : groups) {
      std::map<std::string, std::uint64_t> members;
      for (const auto& [member, dataset] : datasets) members[member] = add(dataset);
      if (name.empty()) {
        top.merge(members);
      } else {
        top[name] = add(members);
      }
    }
    root_ = add(top);
  }

  std::string take() {
    const std::uint64_t size = file_.size();
    Bytes front;
    front.text("\x89HDF\r\n\x1a\n");
    front.u8(0, 0, 0, 0, 0, 8, 8, 0);  // versions, and the bytes of addresses and lengths
    front.u16(kLeafK);
    front.u16(kNodeK);
    front.u32(0);
    front.u64(0);
    front.u64(kUndefined);
    front.u64(size);
    front.u64(kUndefined);
    front.u64(0);
    front.u64(root_);
    front.fill(kSuperblockBytes);
    return file_.take_behind(front.all());
  }

 private:
  /// Returns the address of the dataset.
  std::uint64_t add(const H5Dataset& dataset) {
    std::uint64_t numbers = 1;
    for (const std::uint64_t size : dataset.shape) numbers *= size;
    const NumberForm form = form_of(dataset.type);
    SIMVIS_ASSERT(dataset.bytes.size() == numbers * form.bytes);
    const std::uint64_t data = dataset.bytes.empty() ? kUndefined : file_.size();
    file_.text(dataset.bytes);
    file_.align();
    Bytes space, type, fill, layout;
    space.u8(1, dataset.shape.size(), 0, 0);
    space.u32(0);
    for (const std::uint64_t size : dataset.shape) space.u64(size);
    // Version 1 with the class; its bits: signed, or for floats the normalised mantissa and the place of the sign.
    type.u8(1 << 4 | (form.is_float ? 1 : 0), form.is_float ? 0x20 : form.is_signed ? 8 : 0, form.is_float ? 31 : 0, 0);
    type.u32(form.bytes);
    type.u16(0);
    type.u16(8 * form.bytes);
    if (form.is_float) {
      type.u8(23, 8, 0, 23);  // place and bits of the exponent and of the mantissa
      type.u32(127);
    }
    fill.u8(2, 1, 0, 0);  // version, space that is there from the beginning, no value
    layout.u8(3, 1);      // version, one piece
    layout.u64(data);
    layout.u64(dataset.bytes.size());
    ObjectHeader header;
    header.add(kDataspace, std::move(space));
    header.add(kDatatype, std::move(type));
    header.add(kFillValue, std::move(fill));
    header.add(kDataLayout, std::move(layout));
    return append(header);
  }

  /// Returns the address of the group with members at these addresses.
  std::uint64_t add(const std::map<std::string, std::uint64_t>& members) {
    SIMVIS_ASSERT(!members.empty() && members.size() <= kMaxH5Members);
    Bytes names;  // of the local heap, behind an empty one
    names.u64(0);
    std::map<std::string, std::uint64_t> place;
    for (const auto& [name, address] : members) {
      place[name] = names.size();
      names.text(name);
      names.u8(0);
      names.align();
    }
    const std::uint64_t heap = file_.size();
    file_.text("HEAP");
    file_.u32(0);
    file_.u64(names.size());
    file_.u64(1);  // nothing is free
    file_.u64(file_.size() + 8);
    file_.text(names.all());
    const std::uint64_t leaf = file_.size();
    file_.text("SNOD");
    file_.u8(1, 0);
    file_.u16(members.size());
    for (const auto& [name, address] : members) {
      const std::uint64_t begin = file_.size();
      file_.u64(place[name]);
      file_.u64(address);
      file_.fill(begin + kEntryBytes);
    }
    file_.fill(leaf + 8 + 2 * kLeafK * kEntryBytes);
    const std::uint64_t tree = file_.size();
    file_.text("TREE");
    file_.u8(0, 0);  // of a group, the lowest level
    file_.u16(1);
    file_.u64(kUndefined);
    file_.u64(kUndefined);
    file_.u64(0);
    file_.u64(leaf);
    file_.u64(place[members.rbegin()->first]);
    file_.fill(tree + 24 + (2 * kNodeK + 1) * 8 + 2 * kNodeK * 8);
    Bytes table;
    table.u64(tree);
    table.u64(heap);
    ObjectHeader header;
    header.add(kSymbolTable, std::move(table));
    return append(header);
  }

  std::uint64_t append(const ObjectHeader& header) {
    const std::uint64_t address = file_.size();
    header.append_to(file_);
    return address;
  }

  Bytes file_;
  std::uint64_t root_ = 0;
};

}  // namespace

std::string encode_h5(const std::map<std::string, H5Group>& groups) { return Writer(groups).take(); }

}  // namespace simvis
