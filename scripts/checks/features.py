"""Write the table of the FMI features of all FMUs, read from their modelDescription.xml, into fmu/SYSTEMS.md."""

import re
from pathlib import Path

from fmpy import read_model_description

ROOT = Path(__file__).resolve().parents[2]


def yes(condition):
    return "yes" if condition else "–"


def table(folder=ROOT / "build" / "fmu"):
    lines = [
        "| FMU | states, inputs, outputs, parameters | state get, set, serialize | directional derivatives | "
        "inputs as polynomials | output derivatives | caller's memory |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for path in sorted(folder.glob("*.fmu")):
        description = read_model_description(path)
        section = description.coSimulation
        causalities = [variable.causality for variable in description.modelVariables]
        sizes = [description.numberOfContinuousStates] + [causalities.count(c) for c in ("input", "output", "parameter")]
        order = section.maxOutputDerivativeOrder
        lines.append(
            f"| {description.modelName} | {', '.join(map(str, sizes))} "
            f"| {yes(section.canGetAndSetFMUstate and section.canSerializeFMUstate)} "
            f"| {yes(section.providesDirectionalDerivative and description.modelExchange.providesDirectionalDerivative)} "
            f"| {yes(section.canInterpolateInputs)} | {f'to order {order}' if order else '–'} "
            f"| {yes(not section.canNotUseMemoryManagementFunctions)} |"
        )
    return "\n".join(lines)


def main():
    page = ROOT / "fmu" / "SYSTEMS.md"
    text = page.read_text()
    page.write_text(re.sub(r"(?<=<!-- features -->\n).*?(?=<!-- end -->)", table() + "\n", text, flags=re.S))


if __name__ == "__main__":
    main()
