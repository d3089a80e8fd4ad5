"""A model file as the classifier of LibEMG, offline and in an online stream.

    python libemg_classifier.py MODEL.intent RECORDING

LibEMG (https://libemg.github.io/libemg) windows the EMG, calls the classifier and sends its decisions by UDP, here with
windows of 10 samples that follow each other and no features: the model takes raw samples, once each and in order. The
decision is the label that a board would have emitted by then.
"""

import sys

import numpy as np
from libemg.emg_predictor import EMGClassifier
from libemg.utils import get_windows

import myointent

WINDOW = 10


class DeviceModel:
    """Model for `EMGClassifier`: the device's pipeline over the windows of one stream, in order."""

    def __init__(self, path):
        self.path = path
        self.stream = None
        self.label = 0

    def fit(self, *_):
        """A model file is trained already."""

    def predict_proba(self, windows):
        """One row a window of shape (8, samples), 1 for the label that holds after it."""
        if self.stream is None:
            # Made where it is used: LibEMG runs an online classifier in a process of its own.
            self.model = myointent.Model(self.path)
            self.stream = myointent.Stream(self.model)
        rows = np.zeros((len(windows), len(self.model.classes)))
        for row, window in zip(rows, windows):
            for event in self.stream.push(np.asarray(window).T):
                if event.label is not None:
                    self.label = self.model.classes.index(event.label)
            row[self.label] = 1
        return rows

    def predict(self, windows):
        return self.predict_proba(windows).argmax(axis=1)


def main(model, recording):
    emg = myointent.read(recording)[0].emg
    # Online: OnlineEMGClassifier(classifier, WINDOW, WINDOW, online_data_handler, features=None).run()
    classifier = EMGClassifier(DeviceModel(model))
    decisions, _ = classifier.run(get_windows(emg, WINDOW, WINDOW))
    changes = np.flatnonzero(np.diff(decisions, prepend=-1))
    for at in changes:
        print(f"{at * WINDOW / 200:8.2f} s  {myointent.INTENTS[decisions[at]]}")


if __name__ == "__main__":
    main(*sys.argv[1:])
