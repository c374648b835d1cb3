#include "program/cli/run_folder.h"

#include <iostream>
#include <set>
#include <string>

#include <simvis/error.h>
#include "engine/base/temporary_file.h"
#include "program/cli/load_scene.h"
#include "program/options/command_line.h"
#include "program/output/atomic_file.h"

namespace simvis {

RunFolder::RunFolder(const Options& options, RunReport& report)
    : options_(options),
      suffix_(report.shard ? report.shard->suffix() : ""),
      report_file_(std::filesystem::path(options.out) / ("run" + suffix_ + ".json")) {
  const bool is_shard = report.shard.has_value();
  if (is_shard) {
    make_folder(options_.out);  // other shards may be about to write there
  } else {
    made_.emplace(options_.out);
  }
  lock_.emplace(options_.out, is_shard);
  remove_unheld_locks(options_.out);
  report_lock_.emplace(report_file_);
  if (is_shard && std::filesystem::exists(std::filesystem::path(options_.out) / "run.json")) {
    throw InputError("--shard: " + options_.out + " has the results of a whole run, expected another --out");
  }
  earlier_ = find_earlier_run(report_file_);
  if (earlier_) require_own_files(*earlier_);
  remove_what_was_left(is_shard);
  if (earlier_ && options_.no_replace) {
    throw InputError("--no-replace: " + report_file_.string() + " is of an earlier run, expected another --out");
  }
  if (options_.resume && earlier_) go_on(report);
  if (is_complete()) return;
  AtomicFile probe(report_file_);  // reports an unwritable folder before the first frame
}

void RunFolder::remove_what_was_left(bool is_shard) const {
  std::set<std::filesystem::path> folders{options_.out};
  if (earlier_) {
    for (const std::filesystem::path& each : written_files(*earlier_, suffix_)) folders.insert(each.parent_path());
  }
  for (const std::filesystem::path& folder : folders) remove_leftovers(folder, is_shard);
}

void RunFolder::go_on(RunReport& report) {
  in_option("--resume", [&] {
    require_same_run(*earlier_, depends_on(to_json(report)));
    require_own_run(*earlier_);
  });
  resumes_ = true;
  report.next_frame = first_frame_ = first_missing_frame(*earlier_, suffix_);
  if (first_frame_ > options_.frames) {
    throw InputError("--resume: the run has " + std::to_string(first_frame_) + " frames, expected --frames " +
                     std::to_string(first_frame_) + " or more");
  }
  if (first_frame_ > 0 && first_frame_ < options_.frames) require_whole_files();
  report.files = earlier_->files;
  if (first_frame_ == options_.frames && !options_.quiet) {
    std::cout << "the run in " << options_.out << " has all of its " << options_.frames << " frames\n";
  }
}

/// A page and a recording cannot be continued: the file would lack the frames of the earlier run.
void RunFolder::require_whole_files() const {
  const std::string lacks = "--resume goes on with frame " + std::to_string(first_frame_) + " and cannot ";
  if (!options_.page.empty()) {
    throw InputError("--page: " + lacks + "continue a page, expected no --page, or a new run without --resume");
  }
  if (!options_.record_pcap.empty()) {
    throw InputError("--record-pcap: " + lacks +
                     "continue a capture file, expected no --record-pcap, or a new run without --resume");
  }
  if (!options_.record.empty() && std::filesystem::exists(options_.record)) {
    throw InputError("--record: " + options_.record + " exists, and " + lacks +
                     "continue a recording, expected another file for the frames that follow, or a new run without "
                     "--resume");
  }
}

void RunFolder::replace() {
  if (!earlier_ || resumes_) return;
  const std::size_t removed = remove_results(*earlier_, suffix_);
  if (!options_.quiet) {
    std::cout << "replaced the results of an earlier run in " << options_.out << " (" << removed << " files)\n";
  }
}

}  // namespace simvis
