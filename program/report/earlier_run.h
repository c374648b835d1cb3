// An earlier run, as its run.json describes it: to replace its files, to go on with it, or to make it again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "program/output/output_writer.h"
#include "program/report/run_inputs.h"

namespace simvis {

struct EarlierRun {
  std::filesystem::path report;                ///< its run.json
  std::string status;                          ///< see RunReport; empty for reports of versions that wrote none
  std::uint64_t frames_wanted = 0;             ///< see RunReport
  std::uint64_t next_frame = 0;                ///< the first frame that was not written, if it did not end by a kill
  std::vector<std::string> command;            ///< its command line
  FileHashes inputs;                           ///< everything that it read
  RecordedVariables environment;               ///< variables that led to what it read
  RunFiles files;                              ///< everything that it wrote, besides the report
  std::map<std::string, std::string> depends;  ///< as depends_on()
};

/// The parts of a report on which the bytes of the results depend, by their key.
std::map<std::string, std::string> depends_on(const std::string& report_json);

/// Reads a report. Throws InputError if the file cannot be read or is no report of a run.
EarlierRun read_report(const std::filesystem::path& report);

/// The run whose results lie in the folder of `report`; empty if there is no such file. Errors as read_report().
std::optional<EarlierRun> find_earlier_run(const std::filesystem::path& report);

/// Throws InputError if a folder of its files is a symbolic link that leads out of the folder of the report: the author
/// of the report may have made the link, and the files behind it are of no run.
void require_own_files(const EarlierRun& run);

/// The files that the run wrote, without its report: tables of poses last, because they name the frames of the others.
/// `suffix` as OutputDesc::suffix.
std::vector<std::filesystem::path> written_files(const EarlierRun& run, const std::string& suffix);

/// Removes these files, folders that are empty then, and the report. Returns the number of files. Throws MachineError
/// if a file cannot be removed.
std::size_t remove_results(const EarlierRun& run, const std::string& suffix);

/// The first frame that has to be made: next_frame, or for a run that was killed or failed the last frame of which
/// there may be a file.
std::uint64_t first_missing_frame(const EarlierRun& run, const std::string& suffix);

/// Throws InputError naming the first file that is missing or has another content than the run read.
void require_same_inputs(const EarlierRun& run);

/// Throws InputError naming the first key of depends_on() in which the runs differ.
void require_same_run(const EarlierRun& run, const std::map<std::string, std::string>& depends);

}  // namespace simvis
