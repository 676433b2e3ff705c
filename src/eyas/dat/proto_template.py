"""Templates in Webots' `.proto` files: text with scripts in JavaScript or Lua between its parts.

Read is what shapes use: variables, fields, arithmetic, texts, lists, conditions, loops and
functions. A script becomes Python functions of ours that count their steps; nothing of it is run as
Python, and whatever else it wants is refused by its name.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from typing import NoReturn

from eyas.dat.proto_script import (
    ARITHMETIC,
    COMPARISONS,
    Function,
    Limits,
    divided,
    length,
    methods_of,
    names_of,
    number,
    same,
    shown,
)

_OPENED = re.compile("%[<{]=?")
_LARGEST_SCRIPT = 1 << 20  # [characters]
_LARGEST_TEXT = 32 << 20  # Largest text that comes out [characters]
_PARAMETERS = 64  # Largest number of words of a function's parameters in parentheses
_MOST_CALLS = 24  # Largest nesting of calls of the script's own functions

_TOKEN = (
    r"(?P<skip>\s+|{})|(?P<number>0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_$][\w$]*)|(?P<text>{})|(?P<mark>{})"
)
_QUOTED = r'"(?:[^"\\\n]|\\.)*"|' + r"'(?:[^'\\\n]|\\.)*'"
_JAVASCRIPT = re.compile(
    _TOKEN.format(
        r"//[^\n]*|/\*(?:[\s\S]*?\*/|[\s\S]*)",
        _QUOTED + r"|`(?:[^`\\]|\\[\s\S])*`|/\\s\+?/g",
        r"===|!==|\*\*|=>|\+\+|--|&&|\|\||\?\?|[=!<>+\-*/%]=|[-+*/%=<>!?:;,.(){}\[\]]",
    )
)
_LUA = re.compile(
    _TOKEN.format(
        r"--\[\[(?:[\s\S]*?\]\]|[\s\S]*)|--[^\n]*",
        _QUOTED,
        r"\.\.|//|[=~<>]=|[-+*/%=<>#;:,.(){}\[\]^]",
    )
)
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r"}

_LEVELS = {
    False: {
        "??": 3, "||": 3, "&&": 4, "===": 6, "!==": 6, "==": 6, "!=": 6, "<": 7, ">": 7, "<=": 7,
        ">=": 7, "+": 9, "-": 9, "*": 10, "/": 10, "%": 10, "**": 12,
    },
    True: {
        "or": 3, "and": 4, "==": 6, "~=": 6, "<": 6, ">": 6, "<=": 6, ">=": 6, "..": 8, "+": 9,
        "-": 9, "*": 10, "/": 10, "//": 10, "%": 10, "^": 12,
    },
}  # fmt: skip
"""How strongly operators bind, by whether the language is Lua."""

_UNARY = 11  # How strongly signs and `not` bind
_RIGHT = ("**", "^", "..")  # Operators of which the last is computed first
_CANONICAL = {
    "||": "or", "&&": "and", "==": "===", "!=": "!==", "~=": "!==", "^": "**",
}  # fmt: skip

Token = tuple[str, str]  # Kind: number, name, text, mark, put (plain text), out, close, end


class _Scope:
    """Variables of a block."""

    __slots__ = ("names", "outer")

    def __init__(self, outer: "_Scope | None", names: dict[str, object] | None = None) -> None:
        self.outer = outer
        self.names = {} if names is None else names

    def owner(self, name: str) -> "dict[str, object] | None":
        """Return the variables among which a name is."""
        scope: _Scope | None = self
        while scope is not None:
            if name in scope.names:
                return scope.names
            scope = scope.outer
        return None


class _Leave(Exception):  # noqa: N818  # not an error
    """Ends a loop, a turn of it, or a function."""

    def __init__(self, what: str, value: object = None) -> None:
        self.what, self.value = what, value


Get = Callable[[_Scope], object]
Set = Callable[[_Scope, object], None]
Term = tuple[Get, Set | None]


def filled_in(text: str, fields: Mapping[str, object], limits: Limits) -> str:
    """Return a text without its templates.

    Args:
        text: The body of a PROTO.
        fields: Values of the PROTO's fields, as scripts see them.
        limits: Counts what is done.

    Raises:
        ValueError: A script cannot be read or computed, or does too much; one line.
    """
    begin = _OPENED.search(text)
    assert begin is not None
    named = re.search(
        r"template ?language: *(lua|javascript)", text[: begin.start()], re.IGNORECASE
    )
    lua = begin[0][1] == "{" if named is None else named[1].lower() == "lua"
    known = _as_tables({**fields}) if lua else {**fields}
    parser = _Parser(list(_tokens(text[begin.start() :], lua=lua)), limits, lua=lua)
    try:
        parser.run({**names_of(limits, lua=lua), "fields": known, "context": {}})
    except _Leave:
        raise ValueError("its template breaks off outside of a loop") from None
    except (TypeError, AttributeError, LookupError, ArithmeticError, StopIteration) as error:
        raise ValueError(f"its template cannot be computed: {error}") from None
    except RecursionError:
        raise ValueError("its template is nested too deep") from None
    return text[: begin.start()] + "".join(parser.made)


def _tokens(text: str, *, lua: bool) -> Iterator[Token]:
    place, size = 0, 0
    while (begin := _OPENED.search(text, place)) is not None:
        yield "put", text[place : begin.start()]
        close = ">%" if begin[0][1] == "<" else "}%"
        end = text.find(close, begin.end())
        if end < 0:
            raise ValueError(f"a template without its end, '{close}'")
        size += end - begin.end()
        if size > _LARGEST_SCRIPT:
            raise ValueError(f"scripts of more than {_LARGEST_SCRIPT} characters")
        if begin[0].endswith("="):
            yield "out", "="
        yield from _words(text[begin.end() : end], _LUA if lua else _JAVASCRIPT)
        if begin[0].endswith("="):
            yield "close", close
        place = end + 2
    yield "put", text[place:]
    yield "end", ""


def _words(code: str, pattern: re.Pattern[str]) -> Iterator[Token]:
    place = 0
    while place < len(code):
        found = pattern.match(code, place)
        if found is None:
            raise ValueError(f"its template has {code[place : place + 20]!r}, which is not read")
        place = found.end()
        if found.lastgroup != "skip":
            yield str(found.lastgroup), found[0]


class _Parser:
    """Makes functions of tokens, one for each statement and expression, and runs them."""

    def __init__(self, tokens: list[Token], limits: Limits, *, lua: bool) -> None:
        self.made: list[str] = []
        self._tokens, self._at, self._lua = tokens, 0, lua
        self._limits, self._methods = limits, methods_of(limits, lua=lua)
        self._calls = self._size = 0

    def run(self, names: dict[str, object]) -> None:
        """Run the whole, with names that are known."""
        body = self._statements(())
        if self._tokens[self._at][0] != "end":
            self._fail()
        scope = _Scope(_Scope(None, names))
        for statement in body:
            statement(scope)

    # Tokens.

    def _fail(self) -> NoReturn:
        kind, word = self._tokens[self._at]
        if kind in ("put", "out", "close", "end"):
            raise ValueError("its template breaks off before it is whole")
        raise ValueError(f"its template has {word[:40]!r}, which is not read")

    def _is(self, *words: str) -> bool:
        kind, word = self._tokens[self._at]
        return kind in ("mark", "name") and word in words

    def _take(self, *words: str) -> str:
        """Return the next word if it is one of some, else nothing."""
        if not self._is(*words):
            return ""
        self._at += 1
        return self._tokens[self._at - 1][1]

    def _need(self, *words: str) -> None:
        if not self._take(*words):
            self._fail()

    def _name(self) -> str:
        kind, word = self._tokens[self._at]
        if kind != "name":
            self._fail()
        self._at += 1
        return word

    def _names(self) -> list[str]:
        names = [self._name()]
        while self._take(","):
            names.append(self._name())
        return names

    # Statements.

    def _statements(self, ends: tuple[str, ...]) -> list[Get]:
        made = []
        while self._tokens[self._at][0] != "end" and not self._is(*ends):
            made.append(self._counted(self._statement()))
        return made

    def _counted(self, what: Get) -> Get:
        spend = self._limits.spend

        def run(scope: _Scope) -> object:
            spend()
            return what(scope)

        return run

    def _block(self, *ends: str) -> Get:
        """Return statements up to a word, which is left; in braces, or one, in JavaScript."""
        if self._lua:
            body = self._statements(ends)
        elif self._take("{"):
            body = self._statements(("}",))
            self._need("}")
        else:
            body = [self._counted(self._statement())]

        def run(scope: _Scope) -> None:
            inner = _Scope(scope)
            for statement in body:
                statement(inner)

        return run

    def _statement(self) -> Get:
        kind, word = self._tokens[self._at]
        if kind == "put":
            self._at += 1
            return lambda _: self._put(word)
        if kind == "out":
            self._at += 1
            value = self._expression()
            if self._tokens[self._at][0] != "close":
                self._fail()
            self._at += 1
            return lambda scope: self._put(shown(value(scope)))
        if kind == "name":
            named = _STATEMENTS[self._lua].get(word)
            if named is not None:
                self._at += 1
                return named(self)
        if not self._lua and self._is("{"):
            return self._block()
        if self._take(";"):
            return lambda _: None
        made = self._assignment()
        self._take(";")
        return made

    def _put(self, text: str) -> None:
        self._size += len(text)
        if self._size > _LARGEST_TEXT:
            raise ValueError("its template puts out too much")
        self._limits.spend(len(text) / 64.0)
        self.made.append(text)

    def _assignment(self) -> Get:
        """Return an expression, or in Lua an assignment of one or several."""
        if not self._lua:
            return self._expression()
        terms = [self._term(0)]
        while self._take(","):
            terms.append(self._term(0))
        if not self._take("="):
            return terms[0][0]
        values = self._several()
        return self._assigned([put or self._fail() for _, put in terms], values)

    def _several(self) -> list[Get]:
        values = [self._expression()]
        while self._take(","):
            values.append(self._expression())
        return values

    def _assigned(self, targets: list[Set], values: list[Get]) -> Get:
        def run(scope: _Scope) -> None:
            self._limits.spend(len(targets))
            found = [value(scope) for value in values]
            for k, put in enumerate(targets):
                put(scope, found[k] if k < len(found) else None)

        return run

    def _let(self) -> Get:
        """Read `let a = 1, b` or `local a, b = 1, 2`."""
        if self._lua:
            if self._take("function"):
                return self._function_statement(local=True)
            names = self._names()
            values = self._several() if self._take("=") else []
            return self._assigned([_local(name) for name in names], values)
        made = []
        while True:
            name = self._name()
            value: Get = self._expression() if self._take("=") else _nothing
            made.append(self._assigned([_local(name)], [value]))
            if not self._take(","):
                break
        self._take(";")
        return lambda scope: [one(scope) for one in made]

    def _function_statement(self, *, local: bool = False) -> Get:
        name = self._name()
        function = self._function()
        put = _local(name) if local or not self._lua else _variable(name, lua=self._lua)[1]
        return lambda scope: put(scope, function(scope))

    def _parameters(self) -> list[str]:
        self._need("(")
        names = [] if self._is(")") else self._names()
        self._need(")")
        return names

    def _function(self) -> Get:
        """Read parameters and a body."""
        return self._callable(self._parameters(), self._body("end"))

    def _body(self, end: str) -> Get:
        body = self._block(end)
        if self._lua:
            self._need(end)
        return body

    def _callable(self, names: list[str], body: Get) -> Get:
        def made(scope: _Scope) -> Function:
            def call(*values: object) -> object:
                self._limits.spend(len(names))
                self._calls += 1
                if self._calls > _MOST_CALLS:
                    raise ValueError("its template calls functions too deep")
                given = dict.fromkeys(names) | dict(zip(names, values, strict=False))
                try:
                    return body(_Scope(scope, given))
                except _Leave as left:
                    if left.what != "return":
                        raise
                    return left.value
                finally:
                    self._calls -= 1

            return call

        return made

    def _if(self) -> Get:
        test = self._condition("then")
        first = self._block("else", "elseif", "end")
        second: Get = _nothing
        if self._take("elseif"):
            second = self._if()
        elif self._take("else"):
            second = self._block("end")
            if self._lua:
                self._need("end")
        elif self._lua:
            self._need("end")
        return lambda scope: (first if self._true(test(scope)) else second)(scope)

    def _condition(self, end: str) -> Get:
        if not self._lua:
            self._need("(")
        test = self._expression()
        self._need(end if self._lua else ")")
        return test

    def _true(self, value: object) -> bool:
        if self._lua:
            return value is not None and value is not False
        return bool(value) if isinstance(value, str | float | bool) else value is not None

    def _while(self) -> Get:
        test = self._condition("do")
        body = self._body("end")
        return self._loop(lambda scope: self._true(test(scope)), body, _nothing)

    def _loop(self, test: Callable[[_Scope], bool], body: Get, after: Get) -> Get:
        def run(scope: _Scope) -> None:
            while test(scope):
                if not self._turn(body, scope):
                    break
                after(scope)

        return run

    def _turn(self, body: Get, scope: _Scope) -> bool:
        """Run a loop's body once; return whether the loop goes on."""
        self._limits.spend()
        try:
            body(scope)
        except _Leave as left:
            if left.what == "return":
                raise
            return left.what == "continue"
        return True

    def _each(self, names: list[str], values: Get, body: Get) -> Get:
        """Return a loop over a list, a text, or what Lua's iterators yield."""

        def run(scope: _Scope) -> None:
            found = values(scope)
            self._limits.weigh(found)
            if not isinstance(found, list | str | Iterator):
                raise ValueError("its template loops over what is no list")
            for one in found:
                each = one if isinstance(one, tuple) else (one,)
                inner = _Scope(scope, dict(zip(names, each, strict=False)))
                if not self._turn(body, inner):
                    break

        return run

    def _for_javascript(self) -> Get:
        self._need("(")
        declared = self._take("let", "const", "var")
        if declared and self._tokens[self._at + 1] in (("name", "of"), ("name", "in")):
            name, word = self._name(), self._name()
            values = self._expression()
            self._need(")")
            keys: Get = lambda scope: _keys(values(scope))  # noqa: E731
            return self._each([name], values if word == "of" else keys, self._block())
        start = _nothing if self._is(";") else self._let() if declared else self._expression()
        if self._tokens[self._at - 1] != ("mark", ";"):
            self._need(";")
        test: Get = (lambda _: True) if self._is(";") else self._expression()
        self._need(";")
        steps = [] if self._is(")") else [self._counted(one) for one in self._several()]
        self._need(")")
        body = self._block()

        def run(scope: _Scope) -> None:
            inner = _Scope(scope)
            start(inner)
            loop(inner)

        loop = self._loop(
            lambda scope: self._true(test(scope)), body, lambda scope: [one(scope) for one in steps]
        )
        return run

    def _for_lua(self) -> Get:
        names = self._names()
        if not self._take("="):
            self._need("in")
            values = self._expression()
            self._need("do")
            return self._each(names, values, self._body("end"))
        ends = self._several()
        self._need("do")
        body = self._body("end")

        def run(scope: _Scope) -> None:
            at, last, step = ([number(end(scope)) for end in ends] + [1.0])[:3]
            while (at <= last) if step > 0.0 else (at >= last):
                if not self._turn(body, _Scope(scope, {names[0]: at})):
                    break
                at += step

        return run

    def _repeat(self) -> Get:
        body = self._body("until")
        test = self._expression()

        def run(scope: _Scope) -> None:
            while self._turn(body, scope) and not self._true(test(scope)):
                pass

        return run

    def _do(self) -> Get:
        return self._body("end")

    def _return(self) -> Get:
        ended = self._is("}", "end", ";") or self._tokens[self._at][0] in ("put", "end")
        value: Get = _nothing if ended else self._expression()
        self._take(";")

        def run(scope: _Scope) -> None:
            raise _Leave("return", value(scope))

        return run

    def _leave(self) -> Get:
        what = self._tokens[self._at - 1][1]
        self._take(";")

        def run(_: _Scope) -> None:
            raise _Leave(what)

        return run

    def _import(self) -> Get:
        """Read `import * as wbrandom from '...'`: what is known has its name anyway."""
        while self._tokens[self._at][0] != "text":
            if self._tokens[self._at][0] in ("put", "end"):
                self._fail()
            self._at += 1
        self._at += 1
        self._take(";")
        return _nothing

    def _throw(self) -> Get:
        value = self._expression()
        self._take(";")

        def run(scope: _Scope) -> None:
            raise ValueError(f"its template refuses its fields: {value(scope)!s:.80}")

        return run

    # Expressions.

    def _expression(self) -> Get:
        return self._term(0)[0]

    def _term(self, level: int) -> Term:
        term = self._postfix(self._primary())
        while True:
            kind, word = self._tokens[self._at]
            binds = _LEVELS[self._lua].get(word, 0) if kind in ("mark", "name") else 0
            if binds > level:
                self._at += 1
                right = self._term(binds - (word in _RIGHT))[0]
                term = self._binary(_CANONICAL.get(word, word), term[0], right), None
            elif not self._lua and level < 2 and self._take("?"):
                term = self._choice(term[0]), None
            elif not self._lua and level < 2 and self._is("=", "+=", "-=", "*=", "/="):
                term = self._assign(term), None
            else:
                return term

    def _choice(self, test: Get) -> Get:
        first = self._term(1)[0]
        self._need(":")
        second = self._term(1)[0]
        return lambda scope: (first if self._true(test(scope)) else second)(scope)

    def _assign(self, term: Term) -> Get:
        get, put = term
        if put is None:
            self._fail()
        word = self._take("=", "+=", "-=", "*=", "/=")
        value = self._term(0)[0]
        if word != "=":
            value = self._binary(word[0], get, value)

        def run(scope: _Scope) -> object:
            found = value(scope)
            put(scope, found)
            return found

        return run

    def _binary(self, word: str, left: Get, right: Get) -> Get:
        spend, lua = self._limits.spend, self._lua
        if word in ("or", "and", "??"):

            def chosen(scope: _Scope) -> object:
                found = left(scope)
                done = found is not None if word == "??" else self._true(found) == (word == "or")
                return found if done else right(scope)

            return chosen
        if word in ("===", "!=="):

            def equal(scope: _Scope) -> bool:
                a, b = left(scope), right(scope)
                self._limits.weigh(a, b)
                return same(a, b) == (word == "===")

            return equal
        compare = COMPARISONS.get(word)
        compute = (
            ARITHMETIC["mod" if lua and word == "%" else word]
            if not compare and word != ".."
            else divided
        )

        def run(scope: _Scope) -> object:
            spend()
            a, b = left(scope), right(scope)
            if compare is not None:
                texts = isinstance(a, str) and isinstance(b, str)
                return compare(a, b) if texts else compare(number(a), number(b))
            if word == ".." or (
                word == "+" and not lua and (isinstance(a, str) or isinstance(b, str))
            ):
                return self._limits.text([shown(a), shown(b)])
            return compute(number(a), number(b))

        return run

    def _primary(self) -> Term:
        kind, word = self._tokens[self._at]
        self._at += 1
        if kind == "number":
            value = float(int(word, 16)) if word[:2] in ("0x", "0X") else float(word)
            return (lambda _: value), None
        if kind == "text":
            return self._text(word), None
        if kind == "name":
            return self._word(word)
        if kind == "mark" and word in ("-", "+", "!", "#", "++", "--"):
            return self._unary(word), None
        if kind == "mark" and word == "(":
            return self._parenthesis(), None
        if kind == "mark" and word == "{":
            return self._table(), None
        if kind == "mark" and word == "[" and not self._lua:
            return self._all_of(self._values("]")), None
        self._at -= 1
        return self._fail()

    def _word(self, word: str) -> Term:
        constants = _CONSTANTS[self._lua]
        if word in constants:
            return (lambda _: constants[word]), None
        if word == "function":
            return self._function(), None
        if word == ("not" if self._lua else "typeof"):
            return self._unary(word), None
        if not self._lua and self._is("=>"):
            return self._arrow([word]), None
        if word == "new" and not self._lua:
            self._need("Array")
            self._need("(")
            return self._new_list(self._values(")")), None
        return _variable(word, lua=self._lua)

    def _new_list(self, values: list[Get]) -> Get:
        def run(scope: _Scope) -> list[object]:
            made = [value(scope) for value in values]
            if len(made) != 1:
                return made
            self._limits.spend(number(made[0]))
            return [None] * int(number(made[0]))

        return run

    def _unary(self, word: str) -> Get:
        term = self._term(_UNARY)
        value = term[0]
        if word in ("++", "--"):
            return self._step(term, word, before=True)
        if word in ("!", "not"):
            return lambda scope: not self._true(value(scope))
        if word == "#":
            return lambda scope: self._length(value(scope))
        if word == "typeof":
            return lambda scope: _TYPES.get(type(value(scope)), "object")
        sign = -1.0 if word == "-" else 1.0
        return lambda scope: sign * number(value(scope))

    def _length(self, value: object) -> float:
        if isinstance(value, dict) and float(len(value)) not in value:
            self._limits.weigh(value)
        return length(value)

    def _step(self, term: Term, word: str, *, before: bool) -> Get:
        get, put = term
        if put is None:
            self._fail()
        step = 1.0 if word == "++" else -1.0

        def run(scope: _Scope) -> float:
            found = number(get(scope))
            put(scope, found + step)
            return found + step * before

        return run

    def _parenthesis(self) -> Get:
        """Read what is in parentheses, or a function with `=>`."""
        depth, after = 1, self._at
        last = min(len(self._tokens) - 1, self._at + _PARAMETERS)
        while depth and after < last and not self._lua:
            depth += (self._tokens[after] == ("mark", "(")) - (self._tokens[after] == ("mark", ")"))
            after += 1
        if not depth and self._tokens[after] == ("mark", "=>"):
            self._at -= 1
            return self._arrow(self._parameters())
        value = self._expression()
        self._need(")")
        return value

    def _arrow(self, names: list[str]) -> Get:
        self._need("=>")
        if self._is("{"):
            return self._callable(names, self._block())
        value = self._expression()

        def run(scope: _Scope) -> None:
            raise _Leave("return", value(scope))

        return self._callable(names, run)

    def _values(self, end: str) -> list[Get]:
        values = []
        while not self._is(end):
            values.append(self._expression())
            if not self._take(","):
                break
        self._need(end)
        return values

    def _all_of(self, values: list[Get]) -> Get:
        def run(scope: _Scope) -> list[object]:
            self._limits.spend(len(values))
            return [value(scope) for value in values]

        return run

    def _table(self) -> Get:
        """Read an object of JavaScript, or a table of Lua."""
        pairs: list[tuple[Get, Get]] = []
        count = 0.0
        while not self._is("}"):
            key, value = self._pair()
            if key is None:
                count += 1.0
                key = _constant(count)
            pairs.append((key, value))
            if not self._take(",", ";"):
                break
        self._need("}")

        def run(scope: _Scope) -> dict[object, object]:
            self._limits.spend(len(pairs))
            return {key(scope): value(scope) for key, value in pairs}

        return run

    def _pair(self) -> tuple[Get | None, Get]:
        after = self._tokens[self._at + 1]
        if self._lua:
            if self._take("["):
                key = self._expression()
                self._need("]")
                self._need("=")
                return key, self._expression()
            if after == ("mark", "="):
                name = self._name()
                self._need("=")
                return _constant(name), self._expression()
            return None, self._expression()
        kind, word = self._tokens[self._at]
        self._at += 1
        if kind == "number":
            word = shown(float(word))
        elif kind == "text":
            word = word[1:-1]
        elif kind != "name":
            self._at -= 1
            self._fail()
        if not self._take(":"):
            return _constant(word), _variable(word, lua=False)[0]
        return _constant(word), self._expression()

    def _text(self, word: str) -> Get:
        if word[0] == "/":
            return _constant(re.compile(word[1:-2]))
        body = re.sub(
            r"\\(.)", lambda found: _ESCAPES.get(found[1], found[1]), word[1:-1], flags=re.DOTALL
        )
        if word[0] != "`":
            return _constant(body)
        parts: list[Get] = []
        for k, part in enumerate(re.split(r"\$\{([^{}]*)\}", body)):
            parts.append(self._inner(part) if k % 2 else _constant(part))
        return lambda scope: self._limits.text([shown(part(scope)) for part in parts])

    def _inner(self, code: str) -> Get:
        """Read an expression that is in a text."""
        kept = self._tokens, self._at
        self._tokens, self._at = [*_words(code, _JAVASCRIPT), ("end", "}")], 0
        value = self._expression()
        if self._tokens[self._at][0] != "end":
            self._fail()
        self._tokens, self._at = kept
        return value

    def _postfix(self, term: Term) -> Term:
        while True:
            kind, word = self._tokens[self._at]
            if kind == "text" and self._lua and word[0] != "[":  # f"..."
                self._at += 1
                term = self._call(term[0], [self._text(word)], word), None
            elif self._take("."):
                name = self._name()
                term = (
                    (self._method(term[0], name), None)
                    if not self._lua and self._take("(")
                    else self._member(term[0], _constant(name))
                )
            elif self._lua and self._take(":"):
                name = self._name()
                self._need("(")
                term = self._method(term[0], name), None
            elif self._take("["):
                key = self._expression()
                self._need("]")
                term = self._member(term[0], key)
            elif self._take("("):
                named = self._tokens[self._at - 2][1]
                term = self._call(term[0], self._values(")"), named), None
            elif not self._lua and (step := self._take("++", "--")):
                term = self._step(term, step, before=False), None
            else:
                return term

    def _call(self, function: Get, values: list[Get], named: str) -> Get:
        def run(scope: _Scope) -> object:
            self._limits.spend(len(values))
            called = function(scope)
            if not callable(called):
                raise ValueError(f"its template calls {named!r:.40}, which is not read")
            return called(*[value(scope) for value in values])

        return run

    def _method(self, owner: Get, name: str) -> Get:
        values = self._values(")")

        def run(scope: _Scope) -> object:
            self._limits.spend(len(values))
            one = owner(scope)
            given = [value(scope) for value in values]
            if isinstance(one, dict):
                called = one.get(name)
                given = [one, *given] if self._lua else given
            else:
                called = self._methods.get(type(one), {}).get(name)
                given = [one, *given]
            if not callable(called):
                raise ValueError(f"its template calls {name!r:.40}, which is not read")
            return called(*given)

        return run

    def _member(self, owner: Get, key: Get) -> Term:
        lua, limits = self._lua, self._limits

        def get(scope: _Scope) -> object:
            limits.spend()
            one, at = owner(scope), key(scope)
            if isinstance(one, dict):
                return one.get(at if lua else shown(at))
            if lua or not isinstance(one, list | str):
                raise ValueError(f"its template asks for {at!r:.40} of what is no list or node")
            if at == "length":
                return length(one)
            place = number(at)
            return one[int(place)] if 0.0 <= place < len(one) else None

        def put(scope: _Scope, value: object) -> None:
            one, at = owner(scope), key(scope)
            if isinstance(one, dict):
                one[at if lua else shown(at)] = value
                if lua and value is None:
                    del one[at]
            elif isinstance(one, list):
                gap = max(number(at) + 1.0 - len(one), 0.0)
                limits.spend(gap)
                one += [None] * int(gap)
                one[int(number(at))] = value
            else:
                raise ValueError(f"its template puts {at!r:.40} into what is no list")

        return get, put


def _nothing(_: _Scope) -> None:
    return None


def _constant(value: object) -> Get:
    return lambda _: value


def _local(name: str) -> Set:
    def put(scope: _Scope, value: object) -> None:
        scope.names[name] = value

    return put


def _variable(name: str, *, lua: bool) -> tuple[Get, Set]:
    def get(scope: _Scope) -> object:
        names = scope.owner(name)
        if names is None and not lua:
            raise ValueError(f"its template names {name:.40}, which is not read")
        return None if names is None else names[name]

    def put(scope: _Scope, value: object) -> None:
        names = scope.owner(name)
        while names is None:  # a new global one
            names = None if scope.outer else scope.names
            scope = scope.outer or scope
        names[name] = value

    return get, put


def _keys(value: object) -> list[object]:
    if isinstance(value, list):
        return [str(k) for k in range(len(value))]
    return list(value) if isinstance(value, dict) else []


def _as_tables(value: object) -> object:
    """Return lists as tables of Lua, which count from 1."""
    if isinstance(value, list):
        return {k + 1.0: _as_tables(one) for k, one in enumerate(value)}
    if isinstance(value, dict):
        return {key: _as_tables(one) for key, one in value.items()}
    return value


_CONSTANTS: dict[bool, dict[str, object]] = {
    False: {"true": True, "false": False, "null": None, "undefined": None},
    True: {"true": True, "false": False, "nil": None},
}
_TYPES = {float: "number", str: "string", bool: "boolean", type(None): "undefined"}
_STATEMENTS: dict[bool, dict[str, Callable[[_Parser], Get]]] = {
    False: {
        "let": _Parser._let, "const": _Parser._let, "var": _Parser._let, "if": _Parser._if,
        "for": _Parser._for_javascript, "while": _Parser._while, "return": _Parser._return,
        "break": _Parser._leave, "continue": _Parser._leave, "import": _Parser._import,
        "function": _Parser._function_statement, "throw": _Parser._throw,
    },
    True: {
        "local": _Parser._let, "if": _Parser._if, "for": _Parser._for_lua, "do": _Parser._do,
        "while": _Parser._while, "repeat": _Parser._repeat, "return": _Parser._return,
        "break": _Parser._leave, "function": _Parser._function_statement,
    },
}  # fmt: skip
