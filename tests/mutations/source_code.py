"""Finds a piece of code by the function it stands in, whatever its formatting."""
import re
from functools import cache

TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|^[ \t]*#(?:\\\n|[^\n])*'              # comments and directives, which are left out
    r'|R"(?P<raw>\w*)\(.*?\)(?P=raw)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''
    r"|[A-Za-z_]\w*|\.?\d(?:[eE][+-]|['.\w])*"
    r'|<<=|\.\.\.|->\*?|::|\+\+|--|&&|\|\||[-+*/%&|^=!<>]=|<<|\S', re.S | re.M)
OPENS, CLOSES = {"(": ")", "[": "]", "{": "}"}, {")", "]", "}"}


class Token:
    __slots__ = ("text", "start", "end")

    def __init__(self, found):
        self.text, self.start, self.end = found[0], found.start(), found.end()


def tokens_of(text):
    return [Token(found) for found in TOKEN.finditer(text) if not found[0].lstrip().startswith(("//", "/*", "#"))]


def partners(words):
    """{position of an opening bracket: position of the closing one}."""
    pairs, open_ones = {}, []
    for k, word in enumerate(words):
        if word in OPENS:
            open_ones.append(k)
        elif word in CLOSES and open_ones:
            pairs[open_ones.pop()] = k
    return pairs


def without_angles(words):
    """Words outside of < and >, as template arguments stand."""
    out, depth = [], 0
    for word in words:
        depth += (word == "<") - (word == ">")
        if depth <= 0 and word != ">":
            out.append(word)
    return out


def name_of(head):
    """Name of the block that begins behind these words, such as SoilMotion::begin or class Body; empty: none."""
    while head[:1] == ["template"]:
        depth = 0
        for k, word in enumerate(head):
            depth += (word == "<") - (word == ">")
            if word == ">" and depth == 0:
                break
        head = head[k + 1:]
    if not head or head[0] in ("namespace", "extern", "if", "for", "while", "switch", "do", "else", "enum"):
        return ""
    words = without_angles(head)
    if words[0] in ("class", "struct", "union"):
        words = words[1:words.index(":")] if ":" in words else words[1:]
        return next((word for word in words if word.isidentifier() and word != "alignas"), "")
    end = next((k for k, word in enumerate(words) if word in ("=", "(", "{") and words[k - 1] != "operator" and words[k - 1:k] != ["alignas"]), len(words))
    if end < len(words) and words[end] == "=":
        while end and not words[end - 1].isidentifier():
            end -= 1
    operator = ""
    if "operator" in words[:end]:
        at = words.index("operator")
        operator = "operator" + ("[]" if end == at + 1 else "()" if words[at + 1] == "(" else words[at + 1])
        end = at
    if operator and words[end - 1] != "::":
        return operator
    begin = end
    while begin > 0 and (words[begin - 1].isidentifier() or words[begin - 1] in ("::", "~")):
        if begin < end and words[begin - 1].isidentifier() and words[begin].isidentifier():
            break
        begin -= 1
    return "".join(words[begin:end]) + operator


def blocks_of(words, first, last, outer, pairs):
    """(name, token before it, its last token) of the named blocks among words[first:last], those within classes too."""
    head, k = first, first
    while k < last:
        word = words[k]
        if word == ";" or (word == ":" and words[k - 1] in ("public", "private", "protected")):
            head = k + 1
        elif word in OPENS and k in pairs:
            if word == "{":
                between = words[head:k]
                list_of_members = ")" in between and ":" in between[between.index(")"):]
                if list_of_members and words[k - 1].isidentifier() and words[k - 1] not in ("const", "noexcept", "override", "try"):
                    k = pairs[k] + 1
                    continue
                name = name_of(flat(words, head, k, pairs))
                full = "::".join(part for part in (outer, name) if part)
                if name:
                    yield full, head - 1, pairs[k]
                if not any(w in ("(", "=") for w in without_angles(strip_template(between))):  # a namespace or a class
                    yield from blocks_of(words, k + 1, pairs[k], full, pairs)
                head = pairs[k] + 1
            k = pairs[k]
        elif word == "}":
            head = k + 1
        k += 1


def strip_template(words):
    depth = 0
    if words[:1] != ["template"]:
        return words
    for k, word in enumerate(words):
        depth += (word == "<") - (word == ">")
        if word == ">" and depth == 0:
            return strip_template(words[k + 1:])
    return words


def flat(words, first, last, pairs):
    """Words without what stands in brackets, and without attributes."""
    out, k = [], first
    while k < last:
        if words[k] in OPENS and k in pairs and pairs[k] < last:
            if words[k] == "(" or words[k] == "{":
                out.append(words[k])
            k = pairs[k]
        else:
            out.append(words[k])
        k += 1
    return out


class Code:
    """A source file: its tokens and its named blocks."""

    def __init__(self, text):
        self.tokens = tokens_of(text)
        self.words = [token.text for token in self.tokens]
        self.blocks = list(blocks_of(self.words, 0, len(self.words), "", partners(self.words)))

    def bodies(self, function):
        """(first, last) of the blocks with this name, which may leave out what stands before a ::."""
        return [(first, last) for name, first, last in self.blocks if name == function or name.endswith("::" + function)]

    def places(self, wanted, function):
        """Positions of the tokens `wanted` in the blocks of this name, or in the file where it is empty."""
        found = set()
        for first, last in self.bodies(function) if function else [(-1, len(self.words))]:
            k = first + 1
            while wanted[0] in self.words[k:last]:
                k = self.words.index(wanted[0], k, last)
                if self.words[k:k + len(wanted)] == wanted and k + len(wanted) <= last:
                    found.add(k)
                k += 1
        return sorted(found)


@cache
def code_of(path):
    return Code(path.read_text())
