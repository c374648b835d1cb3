// Records messages to an MCAP file on a thread of its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "messages/mcap_writer.h"
#include "messages/message_outlet.h"

namespace simvis::ros {

/// A file that jobs write to.
class MessageFile : public MessageSink {
 public:
  explicit MessageFile(const std::filesystem::path& file) : writer_(file) {}
  McapWriter& writer() { return writer_; }

 protected:
  void put(const Topic& topic, std::int64_t time_ns, std::string_view bytes) override;

 private:
  McapWriter writer_;
  std::map<std::string, McapWriter::Channel> channels_;
};

/// Jobs fill, encode and write messages; they run in the order in which they were added. What waits holds at most
/// kMaxBytes, or is a single job that holds more.
///
/// Errors   MachineError of the file: thrown by the next call of add() or finish(), and by each one after it.
/// Threads  one thread at a time; jobs run on the recorder's own.
class Recorder {
 public:
  using Job = std::function<void(MessageSink&)>;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

  /// Creates or replaces the file.
  explicit Recorder(const std::filesystem::path& file);
  /// Writes what waits and finishes the file; errors are lost.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// What a job needs of the queue, and what becomes of it when the queue is full.
  enum class WhenFull : std::uint8_t { wait, drop, exceed };
  /// `held_bytes` is the size of the copies that the job works on. Returns false if the job was dropped.
  bool add(std::size_t held_bytes, WhenFull when_full, Job job);
  /// Writes what waits, and the end of the file.
  void finish();

  std::uint64_t messages() const;  ///< written so far
  std::uint64_t bytes() const;     ///< of the file so far

 private:
  struct Waiting {
    std::size_t held_bytes;
    Job job;
  };
  void run();
  void throw_failure();

  MessageFile file_;  // of the thread, while it runs
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  std::size_t held_bytes_ = 0;  // by those that wait and the one that runs
  std::uint64_t messages_ = 0, bytes_ = 0;
  bool ends_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace simvis::ros
