"""Examples of the pages: XML between fences, motions in closed form, and bold numbers."""

import re

import numpy as np


def examples_of(page):
    """Systems, robots and linearizations of a page as text by name."""
    texts = re.findall(r"```xml\n(<(?:system|robot|mujoco|linearization) .*?)```", page, re.S)
    return {re.search(r' (?:name|model)="(\w+)"', text).group(1): text for text in texts}


def stop_time(example):
    """End of the experiment of an example in s; 1 s for one without."""
    found = re.search(r'stopTime="([\d.]+)"', example)
    return float(found.group(1)) if found else 1.0


def check_motion(instance, example, motion, allowed):
    """Step an initialized instance to the end in seven steps, and compare variables with motion(time), a dict of values by name."""
    for time in np.linspace(stop_time(example) / 7, stop_time(example), 7):
        instance.step(time - instance.time)
        for variable, expected in motion(time).items():
            assert abs(instance.get(variable) - expected) <= allowed, (variable, time)


def check_numbers(text, expected):
    """Check that the bold numbers of a text, each with its unit, are these, to the digits shown."""
    shown = re.findall(r"\*\*(-?\d+\.?\d*) [a-zA-Z]\S*\*\*", text)
    assert shown == [f"{value:.{len(digits.partition('.')[2])}f}" for digits, value in zip(shown, expected, strict=True)]


def settings_of(command):
    """The settings NAME=VALUE of a command such as `lagrange-fmu run Arm.xml help=1`."""
    return {name: float(value) for name, value in re.findall(r"(\S+)=(\S+)", command)}
