// Requests that follow a hand: one is in flight, and only the newest of those that came meanwhile is asked next.

/** `answer(question, signal)` resolves to what `show(answer, question)` takes. */
export class Live {
  #answer;
  #show;
  #next = null;
  #flight = null;

  constructor(answer, show) {
    this.#answer = answer;
    this.#show = show;
  }

  /** Asks, after what is in flight, unless a newer question comes before that; `urgent` drops what is in flight. */
  ask(question, urgent = false) {
    if (urgent) this.stop();
    this.#next = question;
    if (!this.#flight) this.#fly();
  }

  /** Whether a newer question than the one that was answered last is still to be asked. */
  get waiting() {
    return this.#next !== null;
  }

  /** Drops what is in flight, and what waits for that. */
  stop() {
    this.#next = null;
    this.#flight?.abort();
    this.#flight = null;
  }

  async #fly() {
    while (this.#next !== null) {
      const question = this.#next, mine = (this.#flight = new AbortController());
      this.#next = null;
      try {
        const answer = await this.#answer(question, mine.signal);
        if (mine !== this.#flight) return;
        this.#show(answer, question);
      } catch (error) {
        if (!mine.signal.aborted) throw error;
        return;
      }
    }
    this.#flight = null;
  }
}
