"""The plugin of pytest and the environment of Gymnasium."""
