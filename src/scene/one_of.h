#pragma once
/// A table of which one key says what its other keys are.
#include "scene/describe.h"
#include "scene/reader.h"
#include "scene/words.h"

namespace talus {

template <class Variant>
void TableReader::one_of(const char *key, Variant &value, const char *meaning) {
  value = make_kind<Variant>(choose(key, kinds_of<Variant>(), meaning).value_or(0));
  std::visit([&](auto &kind) { kind.fields(*this); }, value);
  std::map<std::string, std::string> owners;
  const auto note = [&]<class Kind>(std::type_identity<Kind>) {
    Describer of_kind;
    of_kind.add({}, Kind{});
    for (const Describer::Block &block : of_kind.blocks())
      for (const Describer::Key &one : block.keys) {
        std::string &owner = owners[split(one.path).back()];
        const std::string quoted = std::string("\"") + Kind::name + "\"";
        if (owner.empty())
          owner = std::string(key) + " = " + quoted;
        else if (!owner.ends_with(quoted))
          owner += " or " + quoted;
      }
  };
  [&]<class... Kind>(std::type_identity<std::variant<Kind...>>) {
    (note(std::type_identity<Kind>{}), ...);
  }(std::type_identity<Variant>{});
  elsewhere_.merge(owners);  // of a key within a kind, that one
}

}  // namespace talus
