"""
Write the fuzzer's initial inputs to a folder: corpus.py FOLDER. These are the systems of fmu/ and tests/systems/ and the examples of
fmu/README.md, each also with mistakes. The file `words` next to FOLDER is a dictionary of the language's words.
"""

import random
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXPRESSIONS = "0 1 -1 1e308 1e-308 NaN INF 0.5 q v sin(q) sqrt(q-1) q^0.5 1/q q^-3 abs(q) der(v) der(der(q)) time sum(i,1,3,i) 2**3 9,81 )( q^ [1] x[1][2]".split()
WORDS = subprocess.run([ROOT / "build" / "fuzz" / "bin" / "lagc", "--words"], capture_output=True, text=True, check=True).stdout
FUNCTIONS, NAMES, ELEMENTS = (re.findall(rf"^{kind} (\w+)$", WORDS, re.M) for kind in ("function", "name", "element"))


def systems():
    """Yield names and texts, with few repetitions in each <for>, and with the full path of the system in each <linearization>."""
    for path in sorted([*(ROOT / "fmu").glob("*/system.xml"), *(ROOT / "tests" / "systems").glob("*/system.xml")]):
        text = re.sub(r'(<constant name="\w+" value=")\d+"', r'\g<1>3"', path.read_text())
        yield path.parent.name, text.replace('of="..', f'of="{ROOT / "fmu"}')
    examples = re.findall(r"```xml\n(<(?:system|linearization) .*?)```", (ROOT / "fmu" / "README.md").read_text(), re.S)
    for i, text in enumerate(examples):
        yield f"example-{i}", text


def attribute_changed(text, noise):
    name, value = noise.choice(re.findall(r' (\w+)="([^"]*)"', text))
    other = noise.choice(["", value * 2, noise.choice(EXPRESSIONS), *[v for _, v in re.findall(r' (\w+)="([^"]*)"', text)]])
    return text.replace(f' {name}="{value}"', f' {name}="{other}"', 1)


def attribute_dropped(text, noise):
    return text.replace(noise.choice(re.findall(r' \w+="[^"]*"', text)), "", 1)


def element_moved(text, noise):
    elements = re.findall(r"<\w+ [^<>]*/>|<(?:potential|force|kinetic)\b[^<>]*>[^<>]*</\w+>", text)
    one, other = noise.choice(elements), noise.choice(elements)
    return text.replace(one, other + one if noise.random() < 0.5 else other, 1)


def name_misspelt(text, noise):
    word = noise.choice(re.findall(r"[A-Za-z]\w*", text))
    place = noise.randrange(len(word))
    return text.replace(word, word[:place] + noise.choice(["", "q", "É", "&amp;", "<"]) + word[place + 1 :], 1)


def expression_grown(text, noise):
    number = noise.choice(re.findall(r"\b\d[\d.]*\b|\b[a-z]\b", text))
    inner = noise.choice([number, *EXPRESSIONS])
    grown = noise.choice([f"{noise.choice(FUNCTIONS)}({inner})", f"({number})^{inner}", f"{number}/({inner})", f"{number}-{inner}"])
    return re.sub(rf"\b{re.escape(number)}\b", lambda match: grown, text, count=1)


MISTAKES = [attribute_changed, attribute_dropped, element_moved, name_misspelt, expression_grown]


def mistaken(text, noise, most=3):
    """The text with a few mistakes of the kinds that authors make."""
    for _ in range(noise.randint(1, most)):
        try:
            text = noise.choice(MISTAKES)(text, noise)
        except IndexError:  # nothing left to change
            pass
    return text


def dictionary():
    schema = (ROOT / "fmu" / "system.xsd").read_text()
    words = [*NAMES, *(f"<{name}" for name in ELEMENTS)]
    words += [f" {name}=" for name in re.findall(r'<xs:attribute name="(\w+)"', schema)]
    words += [f"{name}(" for name in FUNCTIONS] + ["&lt;", "&#0;", "kg.m2", "N.m/rad", *EXPRESSIONS]
    return "".join('"%s"\n' % word.replace("\\", "\\\\").replace('"', '\\"') for word in dict.fromkeys(words))


def main(folder, count=200):
    folder.mkdir(parents=True, exist_ok=True)
    noise = random.Random(1)
    originals = dict(systems())
    for name, text in originals.items():
        (folder / f"{name}.xml").write_text(text)
    for i in range(count):
        (folder / f"mistake-{i}.xml").write_text(mistaken(noise.choice(list(originals.values())), noise))
    (folder.parent / "words").write_text(dictionary())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
