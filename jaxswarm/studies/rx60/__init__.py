"""The experiments of the RX60 paper."""
