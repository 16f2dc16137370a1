#include "words.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include <lodestone/core/detail/try.h>

#include "error_size.h"
#include "foreign_words.h"
#include "messages.h"

namespace lodestone::tool {
namespace {

using Words = std::vector<std::string>;

/// How a command without a name is understood.
constexpr const char* kUsualCommand = "build";

tl::unexpected<Error> refuse(const std::string& what, const std::string& command = "") {
  return fail(ErrorCode::InvalidArgument,
              what + "; see lodestone " + (command.empty() ? "" : command + " ") + "--help");
}

std::string with_answer(const std::string& text, std::string_view word, const Words& known) {
  const std::string answer = answer_to(word, known);
  return answer.empty() ? text : text + " (" + answer + ")";
}

bool is_option_word(std::string_view word) { return word.size() > 1 && word[0] == '-'; }

const CLI::App* find_command(const CLI::App& program, const std::string& name) {
  for (const CLI::App* command : program.get_subcommands({}))
    if (command->get_name() == name) return command;
  return nullptr;
}

Words names_of_commands(const CLI::App& program) {
  Words names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

Words names_of_options(const CLI::App& command) {
  Words names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }
bool takes_several(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

/// An option as typed: its name, and the value that stands in the same word.
struct TypedOption {
  std::string name;
  std::optional<std::string> value;
};

TypedOption split_at_equals(const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == word.npos) return {word, std::nullopt};
  return {word.substr(0, equals), word.substr(equals + 1)};
}

/// Finds the option that a word names; null where the command has none of that name.
const CLI::Option* find_option(const CLI::App& command, const std::string& word, TypedOption& typed) {
  typed = split_at_equals(word);
  if (const CLI::Option* whole = command.get_option_no_throw(typed.name)) return whole;
  const bool is_short = word[1] != '-' && typed.name.size() > 2;
  // `-output` is a slip of `--output`, not the file `utput`.
  if (!is_short || command.get_option_no_throw("-" + typed.name) != nullptr) return nullptr;
  const CLI::Option* first = command.get_option_no_throw(word.substr(0, 2));
  if (first == nullptr || !takes_value(*first)) return nullptr;
  typed = {word.substr(0, 2), word.substr(2)};
  return first;
}

/// Whether a word goes on with a list, as `0.25` after `--ratio 0.5`, or ends its number, as `%`.
bool continues_list(const std::string& list, const std::string& word) {
  std::error_code ignored;
  if (list.ends_with(',') || word.starts_with(',')) return true;
  if (std::filesystem::exists(word, ignored)) return false;
  return is_unit(word) || is_quantity(std::string_view(word).substr(0, word.find(',')));
}

/// Joins two parts of a list by its delimiter, if the parser knows one; else the option's own rules part them again.
std::string joined(std::string list, std::string word, char delimiter) {
  if (delimiter == '\0') return list + ' ' + word;
  if (list.ends_with(delimiter)) list.pop_back();
  if (word.starts_with(delimiter)) word.erase(0, 1);
  return list + delimiter + word;
}

/// Reads the words after a command, one by one.
class CommandLine {
 public:
  CommandLine(const CLI::App& command, Words words) : command_(command), words_(std::move(words)) {}

  Result<Words> spell_out() {
    while (has_more()) {
      const std::string& word = take();
      if (word == "--") {
        out_.insert(out_.end(), words_.begin() + next_ - 1, words_.end());
        break;
      }
      LODESTONE_CHECK(add(word));
    }
    if (!unknown_.empty()) return refuse(unknown_, command_.get_name());
    return std::move(out_);
  }

  /// Returns the place of the first word that is neither an option nor an option's value.
  std::optional<std::ptrdiff_t> first_file() {
    while (has_more()) {
      const std::string& word = take();
      if (!is_option_word(word)) return next_ - 1;
      TypedOption typed;
      const CLI::Option* option = word == "--" ? nullptr : find_option(command_, word, typed);
      if (option != nullptr && takes_value(*option) && !typed.value && has_more()) take_value(*option);
    }
    return std::nullopt;
  }

 private:
  bool has_more() const { return static_cast<std::size_t>(next_) < words_.size(); }
  const std::string& peek() const { return words_[static_cast<std::size_t>(next_)]; }
  const std::string& take() { return words_[static_cast<std::size_t>(next_++)]; }

  Result<void> add(const std::string& word) {
    if (!is_option_word(word)) {
      out_.push_back(word);
      return {};
    }
    TypedOption typed;
    const CLI::Option* option = find_option(command_, word, typed);
    if (option == nullptr && is_bundle(word)) {
      out_.push_back(word);
      return {};
    }
    if (option == nullptr) {
      note_unknown(typed.name);
      return {};
    }
    out_.push_back(typed.name);
    if (takes_value(*option)) return add_value(*option, typed);
    if (typed.value) out_.back() += "=" + *typed.value;
    return {};
  }

  /// Whether a word is several options of one letter, none with a value: `-qh`.
  bool is_bundle(const std::string& word) const {
    return word[1] != '-' && std::all_of(word.begin() + 1, word.end(), [&](char letter) {
             const CLI::Option* option = command_.get_option_no_throw(std::string("-") + letter);
             return option != nullptr && !takes_value(*option);
           });
  }

  void note_unknown(const std::string& name) {
    unknown_ += (unknown_.empty() ? "unknown option " : ", unknown option ");
    unknown_ += with_answer(quoted(std::string_view(name)), name, names_of_options(command_));
  }

  Result<void> add_value(const CLI::Option& option, const TypedOption& typed) {
    if (++given_[&option] > 1 && !takes_several(option))
      return refuse(typed.name + " is given twice", command_.get_name());
    if (!typed.value && (!has_more() || command_.get_option_no_throw(peek()) != nullptr))
      return refuse(typed.name + " needs a value, and none follows", command_.get_name());
    out_.push_back(typed.value ? *typed.value : take_value(option));
    return {};
  }

  /// Pre: there is a word left.
  std::string take_value(const CLI::Option& option) {
    std::string value = take();
    while (takes_several(option) && has_more() && continues_list(value, peek()))
      value = joined(value, take(), option.get_delimiter());
    return value;
  }

  const CLI::App& command_;
  Words words_, out_;
  std::ptrdiff_t next_ = 0;  // of the words
  std::map<const CLI::Option*, int> given_;
  std::string unknown_;
};

bool may_be_file(const std::string& word) {
  std::error_code ignored;
  return word == "-" || word.find_first_of("./") != word.npos || std::filesystem::exists(word, ignored);
}

tl::unexpected<Error> refuse_command(const CLI::App& program, const std::string& word) {
  return refuse(with_answer(quoted(std::string_view(word)) + " is neither a command nor a file", word,
                            names_of_commands(program)));
}

/// Brings the command to the front, and puts the usual one there where none is named.
Result<Words> with_command(const CLI::App& program, Words words) {
  const CLI::App* usual = find_command(program, kUsualCommand);
  const auto place = CommandLine(*usual, words).first_file();
  const std::string word = place ? words[static_cast<std::size_t>(*place)] : "";
  if (place && find_command(program, word) != nullptr) {
    std::rotate(words.begin(), words.begin() + *place, words.begin() + *place + 1);
    return words;
  }
  if (place == 0 && !may_be_file(word)) return refuse_command(program, word);
  words.insert(words.begin(), kUsualCommand);
  return words;
}

/// `help`, `help build`, `--help build`, `version`.
std::optional<Result<Words>> about_the_program(const CLI::App& program, const Words& words) {
  const std::string& first = words.front();
  if (first == "version") return Words{"--version"};
  const bool is_help = first == "help" || first == "-h" || first == "--help";
  if (is_help && words.size() > 1) {
    if (find_command(program, words[1]) != nullptr) return Words{words[1], "--help"};
    return refuse_command(program, words[1]);
  }
  if (is_help) return Words{"--help"};
  if (program.get_option_no_throw(first) != nullptr) return words;
  return std::nullopt;
}

}  // namespace

Result<Words> spell_out(const CLI::App& program, Words words) {
  if (words.empty()) return words;
  if (auto about = about_the_program(program, words)) return std::move(*about);
  Result<Words> line = with_command(program, std::move(words));
  if (!line) return line;
  const CLI::App& command = *find_command(program, line->front());
  line->erase(line->begin());
  if (line->size() == 1 && line->front() == "help") return Words{command.get_name(), "--help"};
  line = CommandLine(command, std::move(*line)).spell_out();
  if (line) line->insert(line->begin(), command.get_name());
  return line;
}

}  // namespace lodestone::tool
