"""Formulas of the reference position, such as "0.02*sin(PI*x/0.1)"."""

import ast

import numpy as np

FUNCTIONS = {name: getattr(np, name) for name in "sqrt exp sin cos tan sinh cosh tanh abs".split()}
FUNCTIONS |= {"ln": np.log, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan}
OPERATORS = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
}


def evaluated(text: str, positions: np.ndarray) -> np.ndarray:
    """Values (n,) of a formula at positions (n, 3) [m]."""
    names = {"x": positions[:, 0], "y": positions[:, 1], "z": positions[:, 2], "PI": np.pi}
    # Only what stands here is known: nothing else can be called.
    tree = ast.parse(text.replace("^", "**"), mode="eval")
    return np.broadcast_to(_value(tree.body, names), len(positions)).astype(float)


def _value(node, names: dict):
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return float(node.value)
    if isinstance(node, ast.Name) and node.id in names:
        return names[node.id]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        value = _value(node.operand, names)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](_value(node.left, names), _value(node.right, names))
    if isinstance(node, ast.Call) and getattr(node.func, "id", None) in FUNCTIONS:
        (argument,) = node.args
        return FUNCTIONS[node.func.id](_value(argument, names))
    raise ValueError("a formula has a part that is not known")
