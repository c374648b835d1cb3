// Writes messages on a thread of its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "exchange/messages/mcap_writer.h"
#include "exchange/messages/recorder_sink.h"

namespace simvis::ros {

/// A file that jobs write to.
class MessageFile : public RecorderSink {
 public:
  explicit MessageFile(const std::filesystem::path& file) : writer_(file) {}
  void finish() override { writer_.finish(); }
  std::uint64_t messages() const override { return writer_.messages(); }
  std::uint64_t bytes() const override { return writer_.bytes(); }

 protected:
  McapContent content() const { return writer_.content(); }
  void put(const Topic& topic, std::int64_t time_ns, std::string_view bytes) override;

 private:
  McapWriter writer_;
  std::map<std::string, McapWriter::Channel> channels_;
};

/// Jobs fill, encode and write messages; they run in the order in which they were added. What waits holds at most
/// kMaxBytes, or is a single job that holds more.
///
/// Errors   MachineError of the sink: thrown by the next call of add() or finish(), and by each one after it.
/// Threads  one thread at a time; jobs run on the recorder's own, and on that of a caller that waits for them.
class Recorder {
 public:
  using Job = std::function<void(MessageSink&)>;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

  explicit Recorder(std::unique_ptr<RecorderSink> sink);
  /// Writes what waits and finishes the sink; errors are lost.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// What a job needs of the queue, and what becomes of it when the queue is full.
  enum class WhenFull : std::uint8_t { wait, drop, exceed };
  /// `held_bytes` is the size of what the job works on. Returns false if the job was dropped.
  bool add(std::size_t held_bytes, WhenFull when_full, Job job);
  /// Writes what waits, and finishes the sink.
  void finish();

  std::uint64_t messages() const;  ///< written so far
  std::uint64_t bytes() const;     ///< of all that was written so far

 private:
  struct Waiting {
    std::size_t held_bytes;
    Job job;
  };
  void run();
  bool run_next(std::unique_lock<std::mutex>& lock);
  void throw_failure();

  std::unique_ptr<RecorderSink> sink_;  // of the thread that runs a job
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  std::size_t held_bytes_ = 0;  // by those that wait and the one that runs
  std::uint64_t messages_ = 0, bytes_ = 0;
  bool runs_ = false;  // a job, on any thread
  bool ends_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace simvis::ros
