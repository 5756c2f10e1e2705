"""The loads at failure, with their values: what the functions of a scene give at a time."""

import ast
import math
import operator

import numpy as np

from talus_units import number, quantity, words

DOES = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos}
CALLS = {name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "exp")} | {"min": min, "max": max, "abs": abs}


def value_at(value, time, functions):
    """A value of a scene at a time, a number or a list of them. Raises ValueError where it depends on more than the time."""
    if isinstance(value, list) and value and all(isinstance(one, list) and len(one) == 2 for one in value):
        return float(np.interp(time, *np.transpose([[number(x) for x in one] for one in value])))
    if isinstance(value, list):
        return [value_at(one, time, functions) for one in value]
    try:
        return number(value)
    except ValueError:
        return evaluated(ast.parse(str(value).replace("^", "**"), mode="eval").body, time, functions)


def evaluated(node, time, functions):
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return node.value
    if isinstance(node, ast.Name) and node.id == "t":
        return time
    if isinstance(node, ast.Name) and node.id in functions:
        return value_at(functions[node.id], time, {})
    if isinstance(node, (ast.BinOp, ast.UnaryOp)) and type(node.op) in DOES:
        return DOES[type(node.op)](*(evaluated(one, time, functions) for one in ([node.left, node.right] if isinstance(node, ast.BinOp) else [node.operand])))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS:
        return CALLS[node.func.id](*(evaluated(one, time, functions) for one in node.args))
    raise ValueError(ast.dump(node))


def loads_at(results, model, time):
    """[(what, value in words)] of what changes with time, at a time of the loads [s]: 'water level', '1.37 m'."""
    found, functions = [], results.scene.get("functions", {})
    for key in dict.fromkeys(key for stage in model.stages for key in stage.get("changes", ())):
        *way, last = key.split(".")
        table = results.scene
        for word in way:
            table = table.get(word, {}) if isinstance(table, dict) else {}
        given = table.get(last) if isinstance(table, dict) else None
        if not isinstance(given, dict):
            way, given, table = way, {last: given}, table
        else:
            way, table = [*way, last], given
        path = ".".join([way[0], "NAME", *way[2:]]) if way[:1] and way[0] in ("boundary", "body") else ".".join(way)
        for name, value in given.items():
            unit, over_time = model.keys.about(path, table, name)
            if over_time and name != "kind":
                try:
                    now = value_at(value, time, functions)
                    if now == value_at(value, 0.0, functions) == value_at(value, 1e12, functions):
                        continue
                    text = quantity(float(now), unit, ".3g") if not isinstance(now, list) else f"({', '.join(quantity(float(one), unit, '.3g') for one in now)})"
                    found.append((f"{words(' '.join(way[1:] or way))} {words(name)}".strip(), text))
                except (ValueError, SyntaxError, TypeError, ArithmeticError):
                    continue
    return found or [(f"function {name}", f"{value_at(value, time, {}):.4g}") for name, value in functions.items() if known_at(value, time)]


def known_at(value, time):
    """Is a function one of time alone?"""
    try:
        return isinstance(value_at(value, time, {}), float)
    except (ValueError, SyntaxError, TypeError, ArithmeticError):
        return False
