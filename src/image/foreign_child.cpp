// The two ends of the conversation. The child says what the image is, then answers requests for
// rows until the parent hangs up.
#include "image/foreign_child.h"

#include <sys/socket.h>
#include <sys/wait.h>

#include <array>
#include <utility>

#include "base/side_process.h"

namespace pse::image {
namespace {

constexpr rlim_t most_memory = rlim_t{8} << 30;

struct Request {
  int y0 = 0, y1 = 0;
};

// What is plain in a spec; its texts follow.
struct PlainSpec {
  Window display, data;
  Transfer transfer;
  float gamma, pixel_aspect;
  Alpha alpha;
  double frames_per_second;
  std::uint64_t channels, attributes;
};

bool put_spec(int to, const ImageSpec& spec) {
  const PlainSpec plain{spec.display,      spec.data,
                        spec.transfer,     spec.gamma,
                        spec.pixel_aspect, spec.alpha,
                        spec.frames_per_second, spec.channels.size(),
                        spec.attributes.size()};
  bool good = side::put(to, &plain, sizeof plain) && side::put_all(to, spec.format) &&
              side::put_all(to, spec.storage);
  for (const Channel& channel : spec.channels)
    good = good && side::put_all(to, channel.name) &&
           side::put(to, &channel.type, sizeof channel.type);
  for (const auto& [name, text] : spec.attributes)
    good = good && side::put_all(to, name) && side::put_all(to, text);
  return good;
}

bool get_spec(int from, ImageSpec& spec) {
  PlainSpec plain;
  if (!side::get(from, &plain, sizeof plain) || !side::get_all(from, spec.format) ||
      !side::get_all(from, spec.storage) || plain.channels > 1 << 20)
    return false;
  spec.display = plain.display, spec.data = plain.data;
  spec.transfer = plain.transfer, spec.gamma = plain.gamma;
  spec.pixel_aspect = plain.pixel_aspect, spec.alpha = plain.alpha;
  spec.frames_per_second = plain.frames_per_second;
  spec.channels.resize(plain.channels);
  for (Channel& channel : spec.channels)
    if (!side::get_all(from, channel.name) || !side::get(from, &channel.type, sizeof channel.type))
      return false;
  for (std::uint64_t i = 0; i < plain.attributes; ++i) {
    std::string name;
    if (!side::get_all(from, name) || !side::get_all(from, spec.attributes[name])) return false;
  }
  return true;
}

// Never returns.
[[noreturn]] void serve(
    int line, const std::function<std::unique_ptr<ForeignReader>(std::string& error)>& open,
    rlim_t seconds) {
  side::settle(most_memory, seconds);
  std::string error;
  const std::unique_ptr<ForeignReader> reader = open(error);
  if (!reader && error.empty()) error = "no reader knows it";
  if (!side::put_all(line, error) || !reader || !put_spec(line, reader->spec)) ::_exit(1);
  for (Request request; side::get(line, &request, sizeof request);) {
    const std::size_t values = static_cast<std::size_t>(reader->spec.data.width()) *
                               static_cast<std::size_t>(request.y1 - request.y0) *
                               reader->spec.channels.size();
    // Not set to anything: where the file ends early, most of it is never touched.
    const std::unique_ptr<float[]> rows(new float[values]);
    std::string problem;
    if (!reader->read_rows(request.y0, request.y1, rows.get(), problem) && problem.empty())
      problem = "the rows cannot be decoded";
    if (!side::put_all(line, problem)) break;
    if (problem.empty() && !side::put(line, rows.get(), values * sizeof(float))) break;
  }
  ::_exit(0);
}

class Proxy : public ForeignReader {
 public:
  Proxy(int line, pid_t child) : line_(line), child_(child) {}
  ~Proxy() override { hang_up(); }

  bool get_head(std::string& error) {
    if (side::get_all(line_, error) && !error.empty()) return false;
    return get_spec(line_, spec) || broke_down(error);
  }

  bool read_rows(int y0, int y1, float* to, std::string& error) override {
    const Request request{y0, y1};
    const std::size_t values = static_cast<std::size_t>(spec.data.width()) *
                               static_cast<std::size_t>(y1 - y0) * spec.channels.size();
    if (line_ < 0 || ::send(line_, &request, sizeof request, MSG_NOSIGNAL) != sizeof request ||
        !side::get_all(line_, error))
      return broke_down(error);
    if (!error.empty()) return false;
    return side::get(line_, to, values * sizeof(float)) || broke_down(error);
  }

 private:
  bool broke_down(std::string& error) {
    const int status = hang_up();
    const bool slow = WIFSIGNALED(status) &&
                      (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
    error = slow ? "reading it takes too long" : "its reader broke down";
    return false;
  }

  int hang_up() {
    if (line_ < 0) return 0;
    ::close(std::exchange(line_, -1));
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

  int line_;
  pid_t child_;
};

}  // namespace

std::unique_ptr<ForeignReader> open_in_child(
    const std::function<std::unique_ptr<ForeignReader>(std::string& error)>& open,
    std::uint64_t bytes, std::string& error) {
  std::array<int, 2> ends = {-1, -1};
  const pid_t child =
      ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0 ? ::fork() : -1;
  if (child == 0) {
    ::close(ends[0]);
    serve(ends[1], open, 5 + 2 * static_cast<rlim_t>(bytes >> 20));
  }
  if (ends[1] >= 0) ::close(ends[1]);
  if (child < 0) {
    if (ends[0] >= 0) ::close(ends[0]);
    error = "no process can be started to read it";
    return nullptr;
  }
  auto proxy = std::make_unique<Proxy>(ends[0], child);
  if (!proxy->get_head(error)) return nullptr;
  return proxy;
}

}  // namespace pse::image
