#include "taut/sim/validator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

std::string sentences(const std::vector<ValueComplaint>& complaints) {
  constexpr std::size_t most_shown = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(complaints.size(), most_shown); ++i)
    text += (i ? "\n" : "") + complaints[i].text;
  if (complaints.size() > most_shown)
    text += fmt::format("\nand {} more", complaints.size() - most_shown);
  return text;
}

}  // namespace

InvalidWorld::InvalidWorld(std::vector<ValueComplaint> complaints)
    : InputError(sentences(complaints)), complaints_(std::move(complaints)) {}

void Validator::complain(const std::string& path, const std::string& what) {
  complaints_.push_back({path, path + what});
}

void Validator::complain_whole(const std::string& path, const std::string& text) {
  complaints_.push_back({path, text});
}

void Validator::note(const char* key, const KeyInfo& info) {
  if (info.applies && !info.unset) levels_.back().set.emplace_back(key);
}

void Validator::judge(const char* key, double value, const KeyInfo& info) {
  note(key, info);
  if (!info.applies || info.unset) return;
  if (const std::string problem = problem_of(value, info); !problem.empty())
    complain(levels_.back().path + key, problem);
}

void Validator::number(const char* key, double& value, const KeyInfo& info) {
  judge(key, value, info);
}

void Validator::integer(const char* key, int& value, const KeyInfo& info) {
  judge(key, value, info);
}

void Validator::text(const char* key, std::string& value, const KeyInfo& info) {
  note(key, info);
  if (info.required && info.applies && value.empty())
    complain(levels_.back().path + key, fmt::format(" is missing; expected here: {}", info.doc));
}

void Validator::file(const char* key, std::filesystem::path& value, const KeyInfo& info) {
  note(key, info);
  if (info.required && info.applies && value.empty())
    complain(levels_.back().path + key, fmt::format(" is missing; expected here: {}", info.doc));
}

void Validator::vector(const char* key, Vec3& value, const KeyInfo& info) {
  note(key, info);
  if (!info.applies || info.unset) return;
  for (const double entry : value)
    if (const std::string problem = problem_of(entry, info); !problem.empty())
      return complain(levels_.back().path + key, problem);
}

void Validator::rotation(const char* key, Eigen::Quaterniond& value, const KeyInfo& info) {
  note(key, info);
  if (info.applies && !(std::abs(value.norm() - 1.0) < 1e-6))
    complain(
        levels_.back().path + key,
        fmt::format(": a quaternion of length {} found, 1 expected (w, x, y, z)", value.norm()));
}

void Validator::integers(const char* key, std::vector<Index>& value, const KeyInfo& info) {
  note(key, info);
  if (!info.applies || info.unset) return;
  for (const Index entry : value)
    if (const std::string problem = problem_of(entry, info); !problem.empty())
      return complain(levels_.back().path + key, problem);
}

void Validator::choose(const char* key, int& value, std::span<const char* const> names,
                       const KeyInfo& info) {
  note(key, info);
  if (info.applies && !info.unset && (value < 0 || value >= std::ssize(names)))
    complain(levels_.back().path + key,
             fmt::format(": number {} is no choice: expected one of \"{}\"", value,
                         fmt::join(names, "\", \"")));
}

void Validator::choose_some(const char* key, std::vector<std::string>& value,
                            std::span<const char* const> names, const KeyInfo& info) {
  note(key, info);
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (std::ranges::find(names, value[i]) == names.end())
      return complain(levels_.back().path + key, unknown_name(value[i], names));
    if (std::find(value.begin(), value.begin() + static_cast<std::ptrdiff_t>(i), value[i]) !=
        value.begin() + static_cast<std::ptrdiff_t>(i))
      return complain(levels_.back().path + key, ": \"" + value[i] + "\" stands here twice");
  }
}

void Validator::inside(const std::string& path, const std::function<void()>& described) {
  levels_.push_back({path, complaints_.size(), {}, {}});
  described();
  const Level done = std::move(levels_.back());
  levels_.pop_back();
  const std::string name = path.substr(0, path.empty() ? 0 : path.size() - 1);
  for (const auto& choice : done.choices) {
    std::vector<std::string> present;
    for (const std::string& key : choice)
      if (std::ranges::find(done.set, key) != done.set.end()) present.push_back(key);
    const std::string needs = fmt::format(" needs exactly one of {}", fmt::join(choice, ", "));
    if (present.empty()) complain(name, needs + ", it has none: add one");
    if (present.size() > 1)
      complain(name, fmt::format("{}, it has {}: remove all but one", needs,
                                 fmt::join(present, " and ")));
  }
}

void Validator::table(const char* key, const KeyInfo& info, const std::function<void()>& inner) {
  note(key, info);
  if (info.applies && !info.unset) inside(levels_.back().path + key + ".", inner);
}

void Validator::tables(const char* key, const TableList& items, const KeyInfo& info) {
  note(key, info);
  if (info.required && info.applies && items.size == 0)
    complain(levels_.back().path + key, fmt::format(" is missing; expected here: {}", info.doc));
  for (std::size_t i = 0; i < items.size; ++i)
    inside(fmt::format("{}{}.{}.", levels_.back().path, key, i), [&] { items.visit(i); });
}

void Validator::exactly_one(std::span<const char* const> keys) {
  levels_.back().choices.emplace_back(keys.begin(), keys.end());
}

void Validator::check(bool holds, const char* key, const std::string& message) {
  if (!holds && complaints_.size() == levels_.back().earlier)
    complain(levels_.back().path + key, ": " + message);
}

void Validator::finish() {
  if (!complaints_.empty()) throw InvalidWorld(std::move(complaints_));
}

}  // namespace taut
