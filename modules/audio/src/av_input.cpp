#include "av_input.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <string_view>
#include <vector>

extern "C" {
#include <libavutil/avstring.h>
}

#include "mien/base/bytes.h"
#include "sound_source.h"

namespace mien {
namespace {

// Containers of sound, by libavformat's names. Playlists, network formats and pictures stay out: they could
// name other files, or take text for sound.
constexpr const char* kContainers =
    "aac,ac3,eac3,aiff,amr,ape,asf,au,avi,caf,dts,flac,flv,matroska,mov,mp3,mpc,mpc8,mpeg,mpegts,ogg,tak,tta,"
    "w64,wav,wv";
// libavformat rates its guess from 0 to 100; below this it asks for more data, and noise often looks like
// MP3.
constexpr int kMinProbeScore = AVPROBE_SCORE_RETRY + 1;
constexpr int kIoBufferBytes = 1 << 15;
constexpr const char* kDamagedFix = "Record or export it again";

void silence_libav() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_level(AV_LOG_QUIET); });  // a library does not print
}

int refuse_to_open(AVFormatContext*, AVIOContext**, const char*, int, AVDictionary**) {
  return AVERROR(EACCES);
}

}  // namespace

std::string av_message(int error) {
  if (error == AVERROR_EOF) return "it ends before its sound begins";
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

int AvInput::read_bytes(void* self, std::uint8_t* out, int size) {
  auto& file = static_cast<AvInput*>(self)->file_;
  const std::size_t n =
      file.read(std::span(reinterpret_cast<std::byte*>(out), static_cast<std::size_t>(size)));
  return n == 0 ? AVERROR_EOF : static_cast<int>(n);
}

std::int64_t AvInput::seek(void* self, std::int64_t offset, int whence) {
  auto& file = static_cast<AvInput*>(self)->file_;
  if ((whence & AVSEEK_SIZE) != 0) return file.size();
  whence &= ~AVSEEK_FORCE;
  const std::int64_t base = whence == SEEK_CUR ? file.position() : whence == SEEK_END ? file.size() : 0;
  if (offset < -base || offset > file.size() - base) return AVERROR(EINVAL);
  file.seek(base + offset);
  return base + offset;
}

Status AvInput::open(const std::string& content) {
  silence_libav();
  const Error unknown = file_.error("no sound recognised in it: it holds " + content, kAcceptedFormats);
  auto* buffer = static_cast<unsigned char*>(av_malloc(kIoBufferBytes));
  io_.reset(avio_alloc_context(buffer, kIoBufferBytes, 0, this, &read_bytes, nullptr, &seek));
  const AVInputFormat* container = nullptr;
  if (av_probe_input_buffer2(io_.get(), &container, "", nullptr, 0, 0) < kMinProbeScore) return unknown;
  if (av_match_list(container->name, kContainers, ',') == 0) return unknown;

  AVFormatContext* format = avformat_alloc_context();
  format->pb = io_.get();
  format->io_open = &refuse_to_open;
  format->format_whitelist = av_strdup(kContainers);
  if (const int error = avformat_open_input(&format, "", container, nullptr);
      error < 0)  // frees it on failure
    return file_.error(
        "damaged: it begins like '" + std::string(container->name) + "', but: " + av_message(error),
        kDamagedFix);
  format_.reset(format);
  if (const int error = avformat_find_stream_info(format, nullptr); error < 0)
    return file_.error("damaged: " + av_message(error), kDamagedFix);
  const int index = av_find_best_stream(format, AVMEDIA_TYPE_AUDIO, -1, -1, nullptr, 0);
  if (index < 0)
    return file_.error("no sound track in it ('" + std::string(container->name) + "')",
                       "Export the recording with its sound");
  for (unsigned i = 0; i < format->nb_streams; ++i)
    if (static_cast<int>(i) != index) format->streams[i]->discard = AVDISCARD_ALL;
  stream_ = format->streams[index];
  return Done{};
}

}  // namespace mien
