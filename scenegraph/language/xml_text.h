// An XML file and the places of its elements, checked before it goes to a library whose messages have no places.
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string_view>
#include <utility>

#include "scenegraph/language/source_text.h"

namespace simvis {

class XmlText {
 public:
  /// Throws InputError with the place if the file cannot be read, is not UTF-8 text, is malformed or nests elements too
  /// deeply. The depth is limited because libraries recurse.
  static XmlText read(const std::filesystem::path& file);
  /// As read() of a file, for text that has another source.
  static XmlText read(SourceText source) { return XmlText(std::move(source)); }

  const SourceText& source() const { return source_; }
  const pugi::xml_document& document() const { return document_; }
  Location at(const pugi::xml_node& node) const;

 private:
  explicit XmlText(SourceText source);
  SourceText source_;
  pugi::xml_document document_;
};

}  // namespace simvis
