"""What is built in, as plain data: a list of it needs neither arrays nor a compiler."""

_ARM = tuple(f"joint{j}" for j in range(1, 7))

# Robot -> its joints and what it is.
BUILTIN: dict[str, tuple[tuple[str, ...], str]] = {
    "emps": (("slide",), "electro-mechanical positioning system: one horizontal slide"),
    "kuka_kr300": (
        _ARM,
        "KUKA KR300 R2500 ultra, whose table starts from an upside-down base frame",
    ),
    "rx60": (
        _ARM[:3],
        "first three links of the Staubli RX60, with the parameters its paper prints",
    ),
    "tx40": (_ARM, "Staubli TX40"),
    "ur10e": (_ARM, "Universal Robots UR10e; drive gains as quoted from De Luca's group"),
}
