"""`python -m workbench.cli`."""

import sys

from workbench.cli import entry

sys.exit(entry())
