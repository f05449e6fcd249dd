"""The command lagrange-fmu, which is python -m lagrange_fmu too. Its modules are imported behind a handler of interrupts."""

import os
import signal


def main():
    handler = signal.getsignal(signal.SIGINT)
    if handler is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda *received: os._exit(130))  # an exception amid imports may be lost, or become another
    from .command import main

    signal.signal(signal.SIGINT, handler)
    main()


if __name__ == "__main__":
    main()
