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
  /// Throws InputError with the place if the text is malformed or nests elements too deeply.
  explicit XmlText(SourceText source);

  const SourceText& source() const { return source_; }
  /// White space around texts is removed: readers of numbers fail at it.
  const pugi::xml_document& document() const { return document_; }
  /// The place of an element of the file. An element that was added or renamed later has the place of the file's start.
  Location at(const pugi::xml_node& node) const;

 private:
  SourceText source_;
  pugi::xml_document document_;
};

}  // namespace simvis
