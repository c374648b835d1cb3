// The folder of results, and what an earlier run left in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/base/result_lock.h"
#include "program/options/options.h"
#include "program/output/new_folders.h"
#include "program/report/earlier_run.h"
#include "program/report/run_report.h"

namespace simvis {

class RunFolder {
 public:
  /// Makes and locks the folder, and removes what killed runs left there. With --resume, `report` goes on where the
  /// earlier run ended. Throws InputError with --no-replace if it has results, and if the runs differ; MachineError
  /// if another run uses the folder or the shard, and if nothing can be written there.
  RunFolder(const Options& options, RunReport& report);
  /// Folders that this object made and that are still empty go with it, because the run was refused.
  ~RunFolder() = default;
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& report_file() const { return report_file_; }
  /// Whether the run goes on with an earlier one.
  bool resumes() const { return resumes_; }
  /// Whether the earlier run has all frames already.
  bool is_complete() const { return first_frame_ >= options_.frames && resumes_; }
  /// The first frame that is missing; 0 unless the run resumes.
  std::uint64_t first_frame() const { return first_frame_; }

  /// Removes the results of an earlier run, unless this one goes on with it.
  void replace();

 private:
  void remove_what_was_left(bool is_shard) const;
  void go_on(RunReport& report);
  void require_whole_files() const;

  const Options& options_;
  std::string suffix_;  // of the shard
  std::filesystem::path report_file_;
  std::optional<FolderLock> lock_;
  std::optional<NewFolders> made_;         // removed under the lock
  std::optional<ResultLock> report_lock_;  // keeps the same shard out, and on NFS also runs of other machines
  std::optional<EarlierRun> earlier_;
  bool resumes_ = false;
  std::uint64_t first_frame_ = 0;
};

}  // namespace simvis
