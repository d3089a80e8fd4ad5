"""A classifier of scikit-learn, scored by the same rule as the project's models.

    python sklearn_lda.py RECORDINGS

Each person is held out once. Windows of 0.2 s move by 50 ms; features are each channel's mean absolute value and
waveform length. A label holds from the end of its window on, so it is scored when it is emitted.
"""

import sys

import numpy as np
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

import myointent

WINDOW, STEP = 40, 10


def features(emg):
    """Features of each window, shape (windows, 16); window k ends before sample WINDOW + k * STEP."""
    windows = np.lib.stride_tricks.sliding_window_view(emg.astype(float), WINDOW, axis=0)[::STEP]
    return np.hstack([np.abs(windows).mean(axis=2), np.abs(np.diff(windows, axis=2)).sum(axis=2)])


def emitted(classifier, emg):
    """Label of each sample when it is emitted; -1 before the first."""
    labels = np.full(len(emg), -1, dtype=np.int8)
    if len(emg) >= WINDOW:
        decisions = classifier.predict(features(emg)).astype(np.int8)
        held = np.repeat(decisions, STEP)[: len(emg) - WINDOW + 1]
        labels[WINDOW - 1 : WINDOW - 1 + len(held)] = held
    return labels


def join(rows):
    """One array of several recordings. An unlabelled sample lies between two: nothing is scored across it."""
    gap = np.array([-1], dtype=np.int8)
    return np.concatenate([part for row in rows for part in (row, gap)])


def main(path):
    recordings = [own for own in myointent.read(path, label_lag="each-cue") if (own.labels >= 0).any()]
    for person in sorted({own.person for own in recordings}):
        samples, truth = [], []
        for own in recordings:
            if own.person != person and len(own.emg) >= WINDOW:
                ends = own.labels[WINDOW - 1 :: STEP]
                samples.append(features(own.emg)[ends >= 0])
                truth.append(ends[ends >= 0])
        classifier = make_pipeline(StandardScaler(), LinearDiscriminantAnalysis())
        classifier.fit(np.concatenate(samples), np.concatenate(truth))
        held_out = [own for own in recordings if own.person == person]
        labels = join(emitted(classifier, own.emg) for own in held_out)
        scores = myointent.score(join(own.labels for own in held_out), labels).results
        median = scores["latency"] and scores["latency"]["median"]
        latency = f"{median['ms']:.0f} ms" if isinstance(median, dict) else "more than half missed"
        print(
            f"{person}: balanced accuracy {scores['balanced_accuracy']:.3f}, "
            f"gestures recognised {scores['gestures_recognised']}, median latency: {latency if median else 'no gestures'}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
