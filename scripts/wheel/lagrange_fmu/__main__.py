"""Run the command lagrange-fmu; its modules are imported while a handler of interrupts is set."""

from . import interrupts


def main():
    interrupts.end_quietly()
    from .command import main

    interrupts.raise_again()
    main()


if __name__ == "__main__":
    main()
