// Reads an SDF file and the files that it includes.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <simvis/part_importer.h>
#include "import/model/import_report.h"
#include "import/sdf/sdf_model.h"

namespace simvis {

/// Finds the files that SDF files name, as the file that names one sees them, else as the first file does.
class SdfFiles {
 public:
  SdfFiles(const std::filesystem::path& top, std::vector<PackageFolder> packages);

  /// Empty: there is no such file; then, `why` says so, for messages. A file near by that is taken for one of a model
  /// that is not there gives a warning.
  std::optional<std::filesystem::path> find(const std::string& uri, const SdfElement& where, std::string& why);
  /// The SDF file of a model: `uri` names its folder, of which the newest version counts, or the file. Empty: as
  /// above.
  std::optional<std::filesystem::path> find_model(const std::string& uri, const SdfElement& where, std::string& why);
  /// Folders and files that the <uri> of a material script may mean; not all of them exist.
  std::vector<std::filesystem::path> find_scripts(const std::string& uri, const SdfElement& where);
  PackageFiles as_seen_from(const std::filesystem::path& file) const { return {file, packages_}; }
  std::vector<std::string> release_warnings() { return top_.release_warnings(); }

 private:
  std::optional<std::filesystem::path> find_in_folder(const std::filesystem::path& folder);

  std::vector<PackageFolder> packages_;
  PackageFiles top_;
};

/// Reads `file` into `content`, whose address must stay the same while it is used.
///
/// Reports    content that is not taken over; an <include> that is left out, because its file is not there, is on the
///            network or cannot be read; a second item of a name, which gets another name.
/// Throws     InputError with the place: the file cannot be read or is no SDF from version 1.2 on, a name is missing, a
///            pose is wrong, files include each other in a circle or bring more than 20,000 models.
class SdfReader {
 public:
  SdfReader(SdfContent& content, SdfFiles& files, ImportReport& report)
      : content_(content), files_(files), report_(report) {}
  void read(const std::filesystem::path& file);

 private:
  SdfFile& open(const std::filesystem::path& file);
  void read_world(const SdfElement& world);
  void read_scope(const SdfElement& element, SdfScope& scope);
  void read_child(const SdfElement& child, SdfScope& scope);
  void read_frame(const SdfElement& frame, SdfScope& scope);
  void read_joint(const SdfElement& joint, SdfScope& scope);
  void read_include(const SdfElement& include, SdfScope& scope);
  void insert_included(const SdfElement& include, const SdfElement& root, SdfScope& scope);
  SdfItem& add(SdfItemKind kind, const SdfElement& element, std::string name, SdfScope& scope);
  void add_model(const SdfElement& model, const SdfElement* include, SdfScope& outer);
  std::optional<std::uint32_t> label_of(const SdfElement& model, const SdfElement* include);
  void add_light(const SdfElement& light, const SdfElement* include);

  SdfContent& content_;
  SdfFiles& files_;
  ImportReport& report_;
  std::map<std::filesystem::path, SdfFile*> known_;
  std::vector<std::filesystem::path> open_;  // files that are being read, each included by the one before
  std::size_t models_ = 0;
};

/// Whether content of this tag is silently ignored or reported, where a world or a model has it.
void report_unread(const SdfElement& element, ImportReport& report);

}  // namespace simvis
