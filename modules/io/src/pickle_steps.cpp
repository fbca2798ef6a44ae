// The instructions of a pickle, by their letters or numbers in Python's Lib/pickletools.py.
#include <bit>
#include <charconv>

#include "pickle_machine.h"

namespace mien {
namespace {

constexpr unsigned char kNewestProtocol = 5;

// Python's quoted byte string: \n, \\, \', \x41 and the like.
std::optional<Bytes> unquote(std::string_view text) {
  if (text.size() < 2 || text.front() != text.back() || (text.front() != '\'' && text.front() != '"'))
    return std::nullopt;
  text = text.substr(1, text.size() - 2);
  Bytes out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '\\') {
      if (++i == text.size()) return std::nullopt;
      constexpr std::string_view kLetters = "nrtabfv0\\'\"", kMeanings{"\n\r\t\a\b\f\v\0\\'\"", 11};
      if (text[i] == 'x') {
        unsigned value = 0;
        const char* digits = text.data() + i + 1;
        if (text.size() - i < 3 || std::from_chars(digits, digits + 2, value, 16).ptr != digits + 2)
          return std::nullopt;
        c = static_cast<char>(value);
        i += 2;
      } else if (const auto place = kLetters.find(text[i]); place != kLetters.npos) {
        c = kMeanings[place];
      } else {
        return std::nullopt;
      }
    }
    out.push_back(static_cast<std::byte>(c));
  }
  return out;
}

// Text with \u00e4 and \U0001f600, as UTF-8. Other backslashes stand for themselves.
std::optional<Bytes> unescape_unicode(std::string_view text) {
  Bytes out;
  const auto put = [&](unsigned value) { out.push_back(static_cast<std::byte>(value)); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned code = static_cast<unsigned char>(text[i]);  // Latin-1 outside escapes
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'u' || text[i + 1] == 'U')) {
      const std::size_t length = text[i + 1] == 'u' ? 4 : 8;
      const char* digits = text.data() + i + 2;
      if (text.size() - i < 2 + length ||
          std::from_chars(digits, digits + length, code, 16).ptr != digits + length || code > 0x10ffff)
        return std::nullopt;
      i += 1 + length;
    }
    if (code < 0x80) {
      put(code);
    } else if (code < 0x800) {
      put(0xc0u | (code >> 6)), put(0x80u | (code & 0x3fu));
    } else if (code < 0x10000) {
      put(0xe0u | (code >> 12)), put(0x80u | ((code >> 6) & 0x3fu)), put(0x80u | (code & 0x3fu));
    } else {
      put(0xf0u | (code >> 18)), put(0x80u | ((code >> 12) & 0x3fu));
      put(0x80u | ((code >> 6) & 0x3fu)), put(0x80u | (code & 0x3fu));
    }
  }
  return out;
}

}  // namespace

bool PickleMachine::push_decimal(std::string_view digits) {
  if (digits.ends_with('L')) digits.remove_suffix(1);
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (problem == std::errc::result_out_of_range) return push({.kind = PickleKind::big_integer});
  if (problem != std::errc() || end != digits.data() + digits.size()) return fail("has a damaged number");
  return push({.kind = PickleKind::integer, .integer = value});
}

bool PickleMachine::step(unsigned char opcode) {
  switch (opcode) {
    case '.':
      stopped_ = true;
      return true;
    case 0x80: {  // PROTO
      unsigned char protocol = 0;
      if (!number(protocol)) return false;
      return protocol <= kNewestProtocol ||
             fail("has pickle protocol " + std::to_string(protocol) + ", newer than 5");
    }
    case 0x95: {  // FRAME: a hint for readers of streams
      std::uint64_t length = 0;
      return number(length) && (length <= bytes_.size() - position_ || truncated());
    }
    case 'N':
      return push(none_);
    case 0x88:
      return push(true_);
    case 0x89:
      return push(false_);
    case '(':
      marks_.push_back(stack_.size());
      return true;
    case 'I':
    case 'L':
    case 'F':
    case 'S':
    case 'V':
    case 'c':
    case 'i':
    case 'g':
    case 'p':
    case 'P':
      return step_text(opcode);
    case 'J':
    case 'K':
    case 'M':
    case 'G':
    case 0x8a:
    case 0x8b:
    case 'T':
    case 'U':
    case 'X':
    case 'B':
    case 'C':
    case 0x8c:
    case 0x8d:
    case 0x8e:
    case 0x96:
      return step_value(opcode);
    default:
      return step_structure(opcode);
  }
}

bool PickleMachine::step_text(unsigned char opcode) {
  std::string_view text, second;
  if (!line(text)) return false;
  switch (opcode) {
    case 'I':
      if (text == "01") return push(true_);
      if (text == "00") return push(false_);
      return push_decimal(text);
    case 'L':
      return push_decimal(text);
    case 'F': {
      double value = 0;
      const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (problem != std::errc() || end != text.data() + text.size()) return fail("has a damaged number");
      return push({.kind = PickleKind::real, .real = value});
    }
    case 'S': {
      auto bytes = unquote(text);
      if (!bytes) return fail("has a damaged string");
      return push({.kind = PickleKind::text, .text = heap_.keep(std::move(*bytes))});
    }
    case 'V': {
      auto bytes = unescape_unicode(text);
      if (!bytes) return fail("has a damaged string");
      return push({.kind = PickleKind::text, .text = heap_.keep(std::move(*bytes))});
    }
    case 'c':
      return line(second) && push(calls_.global(text, second));
    case 'i': {
      if (!line(second)) return false;
      const PickleRef callee = calls_.global(text, second);
      std::vector<PickleRef> items;
      if (callee == kNoRef || !pop_to_mark(items)) return false;
      items.insert(items.begin(), callee);
      return instance(std::move(items));
    }
    case 'P':
      return fail("refers to something outside the file that is no tensor storage");
    default: {  // g, p
      std::uint64_t index = 0;
      const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), index);
      if (problem != std::errc() || end != text.data() + text.size()) return fail("has a damaged number");
      return opcode == 'g' ? recall(index) : remember(index);
    }
  }
}

bool PickleMachine::step_value(unsigned char opcode) {
  std::string_view text;
  const auto integer = [&](std::int64_t value) {
    return push({.kind = PickleKind::integer, .integer = value});
  };
  switch (opcode) {
    case 'J': {
      std::int32_t value = 0;
      return number(value) && integer(value);
    }
    case 'K': {
      std::uint8_t value = 0;
      return number(value) && integer(value);
    }
    case 'M': {
      std::uint16_t value = 0;
      return number(value) && integer(value);
    }
    case 'G': {  // the one big-endian number
      if (!take(8, text)) return false;
      std::uint64_t bits = 0;
      for (const char c : text) bits = (bits << 8) | static_cast<unsigned char>(c);
      return push({.kind = PickleKind::real, .real = std::bit_cast<double>(bits)});
    }
    case 0x8a:
      return counted<std::uint8_t>(text) && push_long(text);
    case 0x8b:
      return counted<std::uint32_t>(text) && push_long(text);
    case 'T':
    case 'X':
      return counted<std::uint32_t>(text) && push({.kind = PickleKind::text, .text = text});
    case 'U':
    case 0x8c:
      return counted<std::uint8_t>(text) && push({.kind = PickleKind::text, .text = text});
    case 0x8d:
      return counted<std::uint64_t>(text) && push({.kind = PickleKind::text, .text = text});
    case 'B':
      return counted<std::uint32_t>(text) && push({.kind = PickleKind::bytes, .text = text});
    case 'C':
      return counted<std::uint8_t>(text) && push({.kind = PickleKind::bytes, .text = text});
    default:  // BINBYTES8, BYTEARRAY8
      return counted<std::uint64_t>(text) && push({.kind = PickleKind::bytes, .text = text});
  }
}

bool PickleMachine::step_structure(unsigned char opcode) {
  std::vector<PickleRef> items;
  PickleRef a = kNoRef, b = kNoRef;
  std::uint8_t small = 0;
  std::uint32_t large = 0;
  switch (opcode) {
    case ']':
      return push({.kind = PickleKind::list});
    case '}':
      return push({.kind = PickleKind::dict});
    case ')':
      return push({.kind = PickleKind::tuple});
    case 0x8f:
      return push({.kind = PickleKind::set});
    case 'l':
      return pop_to_mark(items) && push({.kind = PickleKind::list, .items = std::move(items)});
    case 't':
      return pop_to_mark(items) && push({.kind = PickleKind::tuple, .items = std::move(items)});
    case 0x91:
      return pop_to_mark(items) && push({.kind = PickleKind::set, .items = std::move(items)});
    case 'd':
      if (!pop_to_mark(items)) return false;
      if (items.size() % 2 != 0) return fail("has a dictionary key without a value");
      return push({.kind = PickleKind::dict, .items = std::move(items)});
    case 0x85:
    case 0x86:
    case 0x87:
      return push_tuple(opcode - 0x84u);
    case 'a':
      return pop(a) && calls_.spend(1) && append(PickleKind::list, {a});
    case 'e':
      return pop_to_mark(items) && append(PickleKind::list, std::move(items));
    case 's':
      return pop(b) && pop(a) && calls_.spend(2) && append(PickleKind::dict, {a, b});
    case 'u':
      return pop_to_mark(items) && append(PickleKind::dict, std::move(items));
    case 0x90:
      return pop_to_mark(items) && append(PickleKind::set, std::move(items));
    case '0':
      if (!marks_.empty() && marks_.back() == stack_.size()) return marks_.pop_back(), true;
      return pop(a);
    case '1':
      return pop_to_mark(items);
    case '2':
      return top(a) && push(a);
    case 'q':
      return number(small) && remember(small);
    case 'r':
      return number(large) && remember(large);
    case 0x94:
      return remember(remembered_);
    case 'h':
      return number(small) && recall(small);
    case 'j':
      return number(large) && recall(large);
    case 'R':
    case 0x81:
      return call_top(false);
    case 0x92:
      return call_top(true);
    case 'o':
      return pop_to_mark(items) && instance(std::move(items));
    case 'b':
      return pop(b) && top(a) && calls_.build(a, b);
    case 'Q':
      return pop(a) && push(calls_.persistent(a));
    case 0x93: {  // STACK_GLOBAL
      if (!pop(b) || !pop(a)) return false;
      const auto& module = heap_.nodes[a];
      const auto& name = heap_.nodes[b];
      if (module.kind != PickleKind::text || name.kind != PickleKind::text)
        return fail("names a class by something that is no text");
      return push(calls_.global(module.text, name.text));
    }
    case 0x82:
    case 0x83:
    case 0x84:
      return fail("uses the extension registry of a Python installation");
    case 0x97:
    case 0x98:
      return fail("refers to buffers outside the file");
    default:
      return fail("has the unknown instruction " + std::to_string(opcode) + "; it may be no pickle");
  }
}

Result<Pickle> Pickle::parse(std::span<const std::byte> bytes, std::string_view name,
                             const PickleOptions& options) {
  auto heap = std::make_unique<PickleHeap>();
  PickleMachine machine(bytes, *heap, options.keep_foreign);
  if (machine.run()) return Pickle(std::move(heap));
  Error error = machine.error();
  error.what = name;
  if (error.code == Errc::input) error.why = "is not a whole Python pickle: it " + error.why;
  return error;
}

Result<Pickle> Pickle::open(const std::filesystem::path& path, const PickleOptions& options) {
  MIEN_TRY(auto file, MappedFile::open(path));
  auto pickle = parse(file.bytes(), "'" + path.string() + "'", options);
  if (pickle) pickle->heap_->file = std::move(file);
  return pickle;
}

}  // namespace mien
