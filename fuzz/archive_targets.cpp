// Zip archives, pickles and the checkpoints made of them.
#include <array>

#include "mien/base/contract.h"
#include "mien/io/pickle.h"
#include "mien/io/torch_checkpoint.h"
#include "mien/io/zip_file.h"
#include "target.h"
#include "zip_for_tests.h"

namespace mien::fuzz {
namespace {

using namespace std::literals;

std::string short_text(std::string_view text) {
  return "U" + std::string(1, static_cast<char>(text.size())) + std::string(text);
}

// A float tensor [2, 3] over storage "0" of six numbers.
const std::string& tensor() {
  static const std::string text = "ctorch._utils\n_rebuild_tensor_v2\n((" + short_text("storage") +
                                  "ctorch\nFloatStorage\n" + short_text("0") + short_text("cpu") +
                                  "I6\ntQI0\n(I2\nI3\nt(I3\nI1\ntI00\nccollections\nOrderedDict\n)RtR";
  return text;
}
std::string state_dict() {
  return "ccollections\nOrderedDict\n)R" + short_text("w") + tensor() + "s" + short_text("b") + tensor() +
         "s}U\x09_metadataNsb.";
}
std::string six_floats() { return std::string(24, '\x3c'); }

// Tensors of a checkpoint must be readable or refused, one by one.
Outcome check(const Result<TorchCheckpoint>& file) {
  if (file)
    for (const auto& tensor_of_file : file->tensors()) {
      const auto bytes = file->read(tensor_of_file.name);
      if (bytes)
        contract(static_cast<std::int64_t>(bytes->size()) ==
                     tensor_of_file.count() * static_cast<std::int64_t>(dtype_size(tensor_of_file.dtype)),
                 "fuzz: a tensor has as many bytes as its shape says");
      (void)file->read_float(tensor_of_file.name);
    }
  return outcome_of(file, file ? file->tensors().size() : 0);
}

std::vector<Bytes> zip_seeds() {
  return {test::make_zip({{"a", "hello"}, {"b/c", std::string(300, 'x'), true}, {"d", ""}}),
          test::make_zip({{"m/data.pkl", state_dict()}, {"m/data/0", six_floats(), true}})};
}
Outcome read_zip(std::span<const std::byte> bytes) {
  const auto zip = ZipFile::parse(bytes, "x");
  std::string how;
  if (zip)
    for (const auto& entry : zip->entries()) {
      Bytes unpacked;
      const auto content = zip->read(entry, unpacked);
      if (content) contract(content->size() == entry.size, "fuzz: an entry has the size that it claims");
      how += content ? '+' : '-';
    }
  Outcome outcome = outcome_of(zip, zip ? zip->entries().size() : 0);
  outcome.how += how;
  return outcome;
}
constexpr std::array<std::string_view, 6> kZipWords = {"PK\x01\x02", "PK\x03\x04", "PK\x05\x06",
                                                       "PK\x06\x06", "PK\x06\x07", "\xff\xff\xff\xff"};

std::vector<Bytes> pickle_seeds() {
  return {
      bytes_of(state_dict()),
      bytes_of("(lp0\nI1\naF1.5\naS'a\\x41'\na."),
      bytes_of("}(U\x01"
               "aK\x01U\x01"
               "bK\x02K\x03\x86u."),
      bytes_of("\x80\x04\x95\x0f\0\0\0\0\0\0\0\x8c\x02hi\x94]\x94(h\0K\x01"
               "e\x86."s),
      bytes_of(
          "cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n(I2\ntcnumpy\ndtype\n"
          "(S'f4'\nI0\nI1\ntR(I3\nS'<'\nNNNI-1\nI-1\nI0\ntbI00\nS'\\x00\\x00\\x80\\x3f\\x00\\x00\\x80\\x3f'"
          "\ntb."),
      bytes_of("\x80\x02\x8a\x0a"
               "0123456789.")};
}

// Everything that can be asked of a value, to a limited depth: values may contain themselves.
void visit(const PickleValue& value, int depth, std::int64_t& left) {
  if (depth > 12 || --left < 0) return;
  (void)value.boolean(), (void)value.integer(), (void)value.number(), (void)value.text(), (void)value.bytes();
  (void)value.storage(), (void)value.tensor(), (void)value.class_name();
  if (const PickleArray* array = value.array(); array != nullptr && array->data.size() < (1u << 20)) {
    (void)array->to_doubles();
    (void)array->to_floats();
  }
  for (std::size_t i = 0; i < value.size() && left > 0; ++i) {
    if (value.kind() == PickleKind::dict) visit(value.key(i), depth + 1, left);
    visit(value[i], depth + 1, left);
  }
  if (const auto state = value.state()) visit(*state, depth + 1, left);
}
Outcome read_pickle(std::span<const std::byte> bytes) {
  (void)Pickle::parse(bytes, "x");
  const auto pickle = Pickle::parse(bytes, "x", {.keep_foreign = true});
  if (pickle) {
    contract(pickle->size() <= bytes.size(), "fuzz: a pickle ends within its bytes");
    std::int64_t left = 5000;
    visit(pickle->root(), 0, left);
  }
  return outcome_of(pickle, pickle ? pickle->root().size() : 0);
}
constexpr std::array<std::string_view, 20> kPickleWords = {"c__builtin__\nset\n",
                                                           "ccollections\nOrderedDict\n",
                                                           "ctorch._utils\n_rebuild_tensor_v2\n",
                                                           "ctorch\nFloatStorage\n",
                                                           "cnumpy\ndtype\n",
                                                           "cnumpy.core.multiarray\n_reconstruct\n",
                                                           "cnumpy.core.multiarray\nscalar\n",
                                                           "cnumpy\nndarray\n",
                                                           "I9223372036854775807\n",
                                                           "I-1\n",
                                                           "p0\n",
                                                           "g0\n",
                                                           "\x80\x04",
                                                           "Q",
                                                           "R",
                                                           "b",
                                                           "(",
                                                           "t",
                                                           "2",
                                                           "0"};

// The pickle of a checkpoint, whose archive is made anew around it: its checksum would stop every damage.
std::vector<Bytes> state_seeds() {
  return {bytes_of(state_dict()),
          bytes_of("}" + short_text("state_dict") + state_dict().substr(0, state_dict().size() - 1) + "s" +
                   short_text("epoch") + "K\x01s.")};
}
Outcome read_state(std::span<const std::byte> bytes) {
  return check(TorchCheckpoint::parse(test::make_zip(
      {{"m/data.pkl", std::string(as_text(bytes))}, {"m/data/0", six_floats()}, {"m/version", "3\n"}})));
}

// Whole files, both forms.
std::vector<Bytes> checkpoint_seeds() {
  // Magic number, protocol, what the machine was, the pickle, the storages' keys, then each storage.
  std::string older = "\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.\x80\x02M\xe9\x03.}" +
                      short_text("little_endian") + "I01\ns." + state_dict() + "](" + short_text("0") + "e.";
  Bytes bytes = bytes_of(older);
  append_le<std::int64_t>(bytes, 6);
  const auto floats = bytes_of(six_floats());
  bytes.insert(bytes.end(), floats.begin(), floats.end());
  return {bytes,
          test::make_zip({{"m/data.pkl", state_dict()}, {"m/data/0", six_floats()}, {"m/version", "3\n"}})};
}
Outcome read_checkpoint(std::span<const std::byte> bytes) {
  return check(TorchCheckpoint::parse({bytes.begin(), bytes.end()}));
}

}  // namespace

Target zip_target() { return {"zip", &zip_seeds, &read_zip, kZipWords}; }
Target pickle_target() { return {"pickle", &pickle_seeds, &read_pickle, kPickleWords}; }
Target torch_state_target() { return {"torch-state", &state_seeds, &read_state, kPickleWords}; }
Target torch_target() { return {"torch", &checkpoint_seeds, &read_checkpoint, kPickleWords}; }

}  // namespace mien::fuzz
