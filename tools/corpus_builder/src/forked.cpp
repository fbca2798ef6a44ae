#include "forked.h"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace mien {
namespace {

struct Child {
  std::int64_t item = 0;
  pid_t pid = -1;
  int pipe = -1;
  Bytes received;  // first byte: 1 result follows, 0 error text follows
};

bool write_all(int fd, const std::byte* data, std::size_t size) {
  while (size > 0) {
    const auto n = ::write(fd, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

[[noreturn]] void run_child(int fd, std::int64_t item,
                            const std::function<Result<Bytes>(std::int64_t)>& work) {
  bool sent = false;
  try {
    const auto result = work(item);
    if (result.has_value()) {
      const std::byte good{1};
      sent = write_all(fd, &good, 1) && write_all(fd, result->data(), result->size());
    } else {
      const std::byte bad{0};
      const std::string text = result.error().message();
      sent = write_all(fd, &bad, 1) && write_all(fd, as_bytes(text).data(), text.size());
    }
  } catch (const std::exception& e) {
    const std::byte bad{0};
    const std::string text = e.what();
    sent = write_all(fd, &bad, 1) && write_all(fd, as_bytes(text).data(), text.size());
  }
  ::_exit(sent ? 0 : 1);  // no destructors: they belong to the parent
}

Result<Child> start(std::int64_t item, const std::function<Result<Bytes>(std::int64_t)>& work) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return Error{Errc::failed, "starting a worker process", "no pipe", ""};
  std::fflush(nullptr);
  const pid_t pid = ::fork();
  if (pid < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    return Error{Errc::failed, "starting a worker process", "fork failed", "Use fewer --jobs"};
  }
  if (pid == 0) {
    ::close(ends[0]);
    run_child(ends[1], item, work);
  }
  ::close(ends[1]);
  return Child{item, pid, ends[0], {}};
}

// True at the end of the child's output.
bool receive(Child& child) {
  std::array<std::byte, 1 << 16> block;
  const auto n = ::read(child.pipe, block.data(), block.size());
  if (n < 0) return errno != EINTR && errno != EAGAIN;
  child.received.insert(child.received.end(), block.begin(), block.begin() + n);
  return n == 0;
}

Result<Bytes> finish(Child& child) {
  ::close(child.pipe);
  int status = 0;
  while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string name = "item " + std::to_string(child.item);
  if (WIFSIGNALED(status))
    return Error{Errc::failed, name, "its process died of signal " + std::to_string(WTERMSIG(status)), ""};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || child.received.empty())
    return Error{Errc::failed, name, "its process ended without a result", ""};
  const std::span<const std::byte> rest = std::span(child.received).subspan(1);
  if (child.received[0] == std::byte{0}) return Error{Errc::failed, name, std::string(as_text(rest)), ""};
  return Bytes(rest.begin(), rest.end());
}

}  // namespace

Status run_forked(int jobs, std::int64_t count, const std::function<Result<Bytes>(std::int64_t)>& work,
                  const std::function<Status(std::int64_t, Result<Bytes>)>& take) {
  const auto at_once = static_cast<std::size_t>(std::max(1, jobs));
  const std::int64_t window = 4 * static_cast<std::int64_t>(at_once);  // results waiting for an earlier item
  std::vector<Child> running;
  std::map<std::int64_t, Result<Bytes>> waiting;
  std::int64_t next_start = 0, next_take = 0;
  Status state = Done{};
  while (next_take < count && state.has_value()) {
    while (running.size() < at_once && next_start < count && next_start < next_take + window) {
      auto child = start(next_start, work);
      if (!child.has_value()) {
        state = child.error();
        break;
      }
      running.push_back(std::move(child).value());
      ++next_start;
    }
    if (!state.has_value()) break;
    std::vector<pollfd> polled;
    for (const auto& c : running) polled.push_back({c.pipe, POLLIN, 0});
    if (!polled.empty() && ::poll(polled.data(), polled.size(), -1) < 0 && errno != EINTR) {
      state = Error{Errc::failed, "waiting for worker processes", "poll failed", ""};
      break;
    }
    for (std::size_t i = running.size(); i-- > 0;) {
      if (polled[i].revents == 0 || !receive(running[i])) continue;
      waiting.emplace(running[i].item, finish(running[i]));
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (auto ready = waiting.find(next_take); ready != waiting.end() && state.has_value();
         ready = waiting.find(next_take)) {
      state = take(next_take, std::move(ready->second));
      waiting.erase(ready);
      ++next_take;
    }
  }
  for (auto& c : running) {
    ::kill(c.pid, SIGTERM);
    (void)finish(c);
  }
  return state;
}

}  // namespace mien
