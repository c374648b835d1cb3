// Encoding on other cores: order, errors and limits are those of one thread.
#include "program/output/encoding_queue.h"

#include <doctest/doctest.h>

#include <chrono>
#include <string>
#include <thread>

#include <simvis/error.h>
#include "engine/base/thread_pool.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr unsigned kThreads[] = {1, 2, 8};

EncodingQueue::Encode text_of(int i) {
  return [i] {
    // Every third one takes long, so that later ones finish before it.
    if (i % 3 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return std::to_string(i) + ' ';
  };
}

TEST_CASE("bytes are written in order on the caller's thread, and the number of pending ones is limited") {
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    EncodingQueue queue(shared_thread_pool(threads));
    std::string all, expected;
    std::size_t put = 0;
    const std::thread::id caller = std::this_thread::get_id();
    for (int i = 0; i < 200; ++i) {
      expected += std::to_string(i) + ' ';
      queue.add(text_of(i), 1, [&](std::string_view bytes) {
        CHECK(std::this_thread::get_id() == caller);
        all += bytes;
        ++put;
      });
      CHECK(static_cast<std::size_t>(i) + 1 - put <= queue.max_pending());
    }
    queue.finish();
    CHECK(all == expected);
    queue.finish();
    CHECK(put == 200);
  }
}

TEST_CASE("an error comes out once all before it have been put; of the rest nothing is put when the queue goes") {
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    for (const bool while_encoding : {true, false}) {
      std::string all;
      {
        EncodingQueue queue(shared_thread_pool(threads));
        bool failed = false;
        for (int i = 0; i < 5; ++i) {
          EncodingQueue::Encode encode = text_of(i);
          if (i == 2 && while_encoding) encode = []() -> std::string { throw MachineError("two"); };
          const auto put = [&, i](std::string_view bytes) {
            if (i == 2) throw MachineError("two");
            all += bytes;
          };
          try {
            queue.add(std::move(encode), 1, put);
          } catch (const MachineError&) {
            failed = true;
            break;
          }
        }
        if (!failed) CHECK_THROWS_WITH_AS(queue.finish(), "two", MachineError);
      }
      CHECK(all == "0 1 ");
    }
  }
}

TEST_CASE("a queue that is held puts nothing until its release, in order then, but for jobs that hold too much") {
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    EncodingQueue queue(shared_thread_pool(threads));
    std::string all, expected;
    const auto add = [&](int i, std::size_t held_bytes) {
      expected += std::to_string(i) + ' ';
      queue.add(text_of(i), held_bytes, [&](std::string_view bytes) { all += bytes; });
    };
    queue.hold();
    for (int i = 0; i < 40; ++i) add(i, 1);
    CHECK(all.empty());
    add(40, EncodingQueue::kMaxBytes);
    CHECK(all == expected.substr(0, expected.find("40 ")));
    queue.hold();
    add(41, 1);
    queue.release();
    for (int i = 42; i < 60; ++i) add(i, 1);
    CHECK(all.size() > expected.find("40 "));
    queue.hold();
    queue.finish();
    CHECK(all == expected);
  }
}

TEST_CASE("jobs that hold much are pending one at a time") {
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    EncodingQueue queue(shared_thread_pool(threads));
    int put = 0;
    for (int i = 0; i < 4; ++i) {
      queue.add(text_of(i), EncodingQueue::kMaxBytes - 1, [&](std::string_view) { ++put; });
      CHECK(put == i);
    }
    queue.finish();
    CHECK(put == 4);
  }
}

TEST_CASE("what was not put when the queue goes never is") {
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    bool put = false;
    {
      EncodingQueue queue(shared_thread_pool(threads));
      queue.add(text_of(0), 1, [&](std::string_view) { put = true; });
    }
    CHECK_FALSE(put);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
